//! The hook of `Trunk.toml`: puts the page where trunk serves it from or leaves it.
//!
//! Trunk copies `web/index.html` as it is and, when it serves, appends its script for reloading. The page takes the place of that
//! copy, and keeps the script.

use std::fs;
use std::path::Path;

use anyhow::Context;

use crate::page::{self, Build};
use crate::process::repository;
use crate::{setup, site_url, sizes};

/// In the page's text, trunk replaces it by another number each time it serves it.
const NONCE: &str = "{{__TRUNK NONCE__}}";

pub fn run() -> anyhow::Result<()> {
    let variable =
        |name: &str| std::env::var(name).with_context(|| format!("{name} is missing: trunk calls this task"));
    let staging = variable("TRUNK_STAGING_DIR")?;
    let staging = Path::new(&staging);
    let index = staging.join("index.html");
    let script = reload_script(&fs::read_to_string(&index).with_context(|| index.display().to_string())?);
    // Without --public-url, it is a slash.
    let url = std::env::var("TRUNK_PUBLIC_URL").ok().and_then(|url| site_url(&url).ok());
    setup::page()?;
    let build = if variable("TRUNK_PROFILE")? == "release" { Build::Optimized } else { Build::Quick };
    page::build(build, &[], url.as_deref(), staging)?;
    if let Some(script) = &script {
        fs::write(&index, with_script(&fs::read_to_string(&index)?, script)?)?;
        fs::copy(repository().join("xtask/site/reload-sw.js"), staging.join("sw.js"))?;
    }
    if build == Build::Optimized { sizes::compress_and_print(script.is_none(), staging) } else { Ok(()) }
}

/// Returns the script that trunk appended to its copy of the page.
fn reload_script(copy: &str) -> Option<String> {
    let script = &copy[copy.rfind(&format!("<script nonce=\"{NONCE}\">"))?..];
    let end = "</script>";
    script.find(end).map(|at| script[..at + end.len()].to_owned())
}

/// Appends a script to a page, and lets the page's policy allow it.
fn with_script(page: &str, script: &str) -> anyhow::Result<String> {
    let policy = "script-src 'self'";
    let allowed = page.replacen(policy, &format!("{policy} 'nonce-{NONCE}'"), 1);
    let (page, end) = allowed.rsplit_once("</body>").context("index.html: expected </body>")?;
    Ok(format!("{page}{script}</body>{end}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_page_that_trunk_serves_has_its_script() {
        let copy = "<body><p></p></body>\n";
        assert_eq!(reload_script(copy), None);
        let script = "<script nonce=\"{{__TRUNK NONCE__}}\">reload</script>";
        assert_eq!(reload_script(&copy.replace("</body>", &format!("{script}</body>"))).as_deref(), Some(script));
    }
}
