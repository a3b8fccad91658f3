//! `gaitway convert`: any readable model as one GLB.

use anyhow::Context;

use super::ConvertArguments;
use crate::files::read_set;
use crate::formats::{LoadOptions, convert};

pub(super) fn run(arguments: &ConvertArguments) -> anyhow::Result<()> {
    let set = read_set(&arguments.input.files)?;
    let options = LoadOptions { bvh_unit_metres: arguments.unit.map(|unit| unit.metres()), ..LoadOptions::default() };
    let bytes = convert(&set, &options)?;
    std::fs::write(&arguments.out, bytes).with_context(|| format!("{}", arguments.out.display()))
}
