//! The same objects in the other encodings.

use miniz_oxide::deflate::compress_to_vec;

/// Unpacked bytes per block: few, so that a test file has several blocks.
const BLOCK: usize = 100;

/// Returns a file of objects as text.
pub fn text(objects: &str) -> Vec<u8> {
    [b"xof 0303txt 0032\n", objects.as_bytes()].concat()
}

/// Returns the same as binary, with floats of that many bytes. Numbers without a point are integers.
pub fn binary(objects: &str, float: usize) -> Vec<u8> {
    let mut file = format!("xof 0303bin {:04}", 8 * float).into_bytes();
    let mut put = |token: u16, rest: &[u8]| file.extend([&token.to_le_bytes(), rest].concat());
    let counted = |count: usize, bytes: &[u8]| [&(count as u32).to_le_bytes(), bytes].concat();
    let spaced = objects.replace('{', " { ").replace('}', " } ").replace([';', ','], " ");
    let mut words = spaced.split_whitespace().peekable();
    while let Some(word) = words.next() {
        match word {
            "{" => put(10, &[]),
            "}" => put(11, &[]),
            "template" => put(31, &[]),
            _ if word.starts_with('"') => {
                let string = word.trim_matches('"');
                put(2, &counted(string.len(), string.as_bytes()));
                put(20, &[]);
            }
            _ if word.parse::<f64>().is_ok() => {
                let is_float = |word: &str| word.contains('.');
                let mut list = vec![word];
                while let Some(next) =
                    words.next_if(|next| next.parse::<f64>().is_ok() && is_float(next) == is_float(word))
                {
                    list.push(next);
                }
                let bytes: Vec<u8> = list.iter().flat_map(|word| number(word, float)).collect();
                match (is_float(word), &list[..]) {
                    (true, _) => put(7, &counted(list.len(), &bytes)),
                    (false, [_]) => put(3, &bytes),
                    (false, _) => put(6, &counted(list.len(), &bytes)),
                }
            }
            _ => put(1, &counted(word.len(), word.as_bytes())),
        }
    }
    file
}

fn number(word: &str, float: usize) -> Vec<u8> {
    match (word.contains('.'), float) {
        (false, _) => word.parse::<u32>().unwrap().to_le_bytes().to_vec(),
        (true, 4) => word.parse::<f32>().unwrap().to_le_bytes().to_vec(),
        (true, _) => word.parse::<f64>().unwrap().to_le_bytes().to_vec(),
    }
}

/// Returns a text or binary file compressed.
pub fn packed(file: &[u8]) -> Vec<u8> {
    let (header, body) = file.split_at(16);
    let blocks = body.chunks(BLOCK).map(|block| (block.len(), compress_to_vec(block, 9)));
    container(header, file.len(), blocks)
}

/// Returns a compressed file of blocks, each a size unpacked and a deflate stream.
pub fn container(header: &[u8], total: usize, blocks: impl Iterator<Item = (usize, Vec<u8>)>) -> Vec<u8> {
    let kind = if &header[8..12] == b"txt " { b"tzip" } else { b"bzip" };
    let mut file = [&header[..8], kind, &header[12..], &(total as u32).to_le_bytes()].concat();
    for (unpacked, stream) in blocks {
        file.extend((unpacked as u16).to_le_bytes());
        file.extend((stream.len() as u16 + 2).to_le_bytes());
        file.extend(b"CK");
        file.extend(stream);
    }
    file
}
