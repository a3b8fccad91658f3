//! A character that is opened and drawn unseen, so that a page compiles and optimizes its code before it is needed: a skinned sheet
//! with the two commonest materials, a base colour map alone, and with a normal map. The image is large enough for a mip level.

/// Vertices along each edge of the sheet. Browsers optimize a loop that has run often.
const SIDE: u16 = 32;

/// Returns the character's files with their names.
pub fn rehearsal_files() -> [(&'static str, Vec<u8>); 2] {
    [("rehearsal.gltf", include_bytes!("rehearsal.gltf").to_vec()), ("rehearsal.bin", buffer())]
}

/// Vertices, indices, and two keys with their times.
fn buffer() -> Vec<u8> {
    let mut bytes = Vec::new();
    let add = |bytes: &mut Vec<u8>, values: &[f32]| values.iter().for_each(|value| bytes.extend(value.to_le_bytes()));
    for vertex in 0..SIDE * SIDE {
        let [x, y] = [vertex % SIDE, vertex / SIDE].map(|at| f32::from(at) / 16.0);
        // Position, normal and texture coordinates; joints; weights.
        add(&mut bytes, &[x, y, 0.0, 0.0, 0.0, 1.0, x, y]);
        bytes.extend([0; 4]);
        add(&mut bytes, &[1.0, 0.0, 0.0, 0.0]);
    }
    for cell in (0..SIDE * (SIDE - 1)).filter(|cell| cell % SIDE < SIDE - 1) {
        let corners = [0, 1, SIDE, SIDE, 1, SIDE + 1].map(|corner| cell + corner);
        corners.iter().for_each(|corner| bytes.extend(corner.to_le_bytes()));
    }
    add(&mut bytes, &[0.0, 1.0]);
    add(&mut bytes, &[[0.0, 0.0, 0.0, 1.0]; 2].concat());
    bytes
}
