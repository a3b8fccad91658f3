//! Material libraries (.mtl): colour, alpha, roughness and a texture. Of the Phong model, `Kd` is the base colour, `d` (or
//! 1 − `Tr`) its alpha, `Ke` the emission, and the specular exponent `Ns` becomes a roughness, `√(2 / (Ns + 2))`, if there is
//! a highlight (`Ks`). Colours are sRGB. `Ka` and the rest are ignored.

use std::collections::BTreeMap;

use gaitway_character::asset::{Warning, Warnings};
use gaitway_character::mesh::{AlphaMode, Material};
use glam::Vec3;

use super::mesh::linear;
use super::text::cut_name;
use crate::encoding;
use crate::lines::{Lines, number, quoted, text};

/// The material of faces without one: light grey, matt. Double-sided, since an .obj does not define front faces.
pub fn plain(name: &str) -> Material {
    Material {
        name: name.to_owned(),
        base_color: Vec3::splat(0.6).extend(1.0),
        metallic: 0.0,
        roughness: 0.7,
        double_sided: true,
        ..Material::default()
    }
}

pub struct MtlMaterial {
    pub material: Material,
    /// The URI of its base colour texture.
    pub image: Option<String>,
}

/// Adds a library's materials by name; the first of a name wins. A bad statement is skipped, the rest of the library is kept.
pub fn read(file: &str, bytes: &[u8], found: &mut BTreeMap<String, MtlMaterial>, warnings: &mut Warnings) {
    let mut open: Option<Statements> = None;
    let bytes = encoding::utf8(bytes);
    let mut lines = Lines::new(&bytes);
    while let Some((line, content)) = lines.next_full_line() {
        let keyword_end = content.iter().position(u8::is_ascii_whitespace).unwrap_or(content.len());
        let (keyword, rest) = (&content[..keyword_end], content[keyword_end..].trim_ascii());
        if keyword == b"newmtl" {
            close(open.take(), found);
            open = Some(Statements { name: cut_name(rest), ..Statements::default() });
            continue;
        }
        if let Some(open) = &mut open
            && let Err(value) = open.read(keyword, rest)
        {
            let place = format!("{file}, line {line}");
            let problem = format!("{} is not a valid value for {}", quoted(Some(value)), text(keyword));
            warnings.push(Warning::Other { code: "material-value", place, problem });
        }
    }
    close(open, found);
}

fn close(statements: Option<Statements>, found: &mut BTreeMap<String, MtlMaterial>) {
    if let Some(statements) = statements {
        found.entry(statements.name.clone()).or_insert_with(|| statements.material());
    }
}

/// The statements of one material.
#[derive(Default)]
struct Statements {
    name: String,
    diffuse: Option<Vec3>,
    specular: Option<Vec3>,
    emissive: Option<Vec3>,
    exponent: Option<f32>,
    alpha: Option<f32>,
    image: Option<String>,
}

impl Statements {
    /// Fails with the part of the line that cannot be read.
    fn read<'a>(&mut self, keyword: &[u8], rest: &'a [u8]) -> Result<(), &'a [u8]> {
        match keyword {
            b"Kd" => self.diffuse = Some(color(rest)?),
            b"Ks" => self.specular = Some(color(rest)?),
            b"Ke" => self.emissive = Some(color(rest)?),
            b"Ns" => self.exponent = Some(value(rest)?),
            b"d" => self.alpha = Some(value(rest.strip_prefix(b"-halo").unwrap_or(rest).trim_ascii())?),
            b"Tr" => self.alpha = Some(1.0 - value(rest)?),
            b"map_Kd" => self.image = image(rest),
            _ => {}
        }
        Ok(())
    }

    fn material(self) -> MtlMaterial {
        let plain = plain(&self.name);
        let has_image = self.image.is_some();
        // Many exporters write black beside a texture and mean the texture alone.
        let diffuse = self.diffuse.map(linear).filter(|color| !has_image || *color != Vec3::ZERO);
        let usual = if has_image { Vec3::ONE } else { plain.base_color.truncate() };
        let alpha = self.alpha.unwrap_or(1.0).clamp(0.0, 1.0);
        let shines = self.specular.is_none_or(|color| color.max_element() > 0.0);
        let exponent = self.exponent.filter(|_| shines).map(|exponent| exponent.max(0.0));
        let roughness = match (exponent, shines) {
            (Some(exponent), _) => (2.0 / (exponent + 2.0)).sqrt(),
            (None, true) => plain.roughness,
            (None, false) => 1.0,
        };
        let material = Material {
            base_color: diffuse.unwrap_or(usual).extend(alpha),
            roughness,
            emissive: linear(self.emissive.unwrap_or(Vec3::ZERO)),
            alpha_mode: if alpha < 1.0 { AlphaMode::Blend } else { AlphaMode::Opaque },
            ..plain
        };
        MtlMaterial { material, image: self.image }
    }
}

/// A single number is a grey.
fn color(rest: &[u8]) -> Result<Vec3, &[u8]> {
    let words = rest.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
    let numbers: Option<Vec<f32>> = words.take(3).map(|word| value(word).ok()).collect();
    match numbers.as_deref() {
        Some([grey]) => Ok(Vec3::splat(*grey)),
        Some(&[red, green, blue]) => Ok(Vec3::new(red, green, blue)),
        _ => Err(rest),
    }
}

fn value(word: &[u8]) -> Result<f32, &[u8]> {
    number(word).map(|value| value as f32).filter(|value| value.is_finite()).ok_or(word)
}

/// Returns the file name, which may have spaces, without the options before it.
fn image(rest: &[u8]) -> Option<String> {
    let rest = text(rest);
    let mut rest = rest.trim();
    while rest.starts_with('-') {
        let (option, after) = rest.split_once(char::is_whitespace)?;
        rest = after.trim_start();
        let values = match option {
            "-mm" => 2,
            // Up to three numbers.
            "-s" | "-o" | "-t" => {
                let words = rest.split_whitespace().take(3);
                words.take_while(|word| word.parse::<f32>().is_ok()).count()
            }
            _ => 1,
        };
        for _ in 0..values {
            rest = rest.split_once(char::is_whitespace)?.1.trim_start();
        }
    }
    // Paths may come from Windows.
    (!rest.is_empty()).then(|| rest.replace('\\', "/"))
}
