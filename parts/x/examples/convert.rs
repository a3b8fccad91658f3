//! Converts .x files: `cargo run -p gaitway-x --example convert -- IN.x OUT.glb`.

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(input), Some(output)) = (arguments.next(), arguments.next()) else {
        return Err("expected IN.x OUT.glb".into());
    };
    let converted = gaitway_x::convert(&std::fs::read(input)?)?;
    for warning in &converted.warnings {
        eprintln!("warning: {warning}");
    }
    std::fs::write(output, converted.bytes)?;
    Ok(())
}
