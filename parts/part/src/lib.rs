//! A *part* of Gaitway converts something that few files contain into plain glTF. Natively it is a crate like any
//! other; on the page it is a separate WebAssembly module, downloaded when a file needs it and run in a worker
//! (`web/shell/parts.js`), so that it can be stopped, and so that a trap ends nothing but the conversion.
//!
//! A part is one function from bytes to an [`Answer`]. [`module!`] exports it: the caller writes the input to where `input(length)`
//! points, calls `run()` and finds the encoded answer at `output()`, `output_length()` bytes of it. If `run()` traps, it finds what
//! the panic said there instead, or nothing.

use std::io::{self, Read, Write};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// What a part returns.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Output {
    /// The converted data.
    pub bytes: Vec<u8>,
    /// What could not be carried over, one sentence each, for the user.
    pub warnings: Vec<String>,
}

/// The error is a message for the user: what was expected, what was found and, if known, what to do.
pub type Answer = Result<Output, String>;

/// First byte of an encoded answer.
const FAILED: u8 = 0;
const CONVERTED: u8 = 1;

/// Encodes an answer as one of its kind, then a message; or then the length of the warnings (u32, little-endian), the warnings
/// with a zero after each, and the data.
pub fn encode(answer: Answer) -> Vec<u8> {
    let mut encoded = Vec::new();
    match answer {
        Err(message) => {
            encoded.push(FAILED);
            encoded.extend_from_slice(message.as_bytes());
        }
        Ok(Output { bytes, warnings }) => {
            encoded.push(CONVERTED);
            let length: usize = warnings.iter().map(|warning| warning.len() + 1).sum();
            encoded.extend_from_slice(&(length as u32).to_le_bytes());
            for warning in &warnings {
                encoded.extend_from_slice(warning.as_bytes());
                encoded.push(0);
            }
            encoded.extend_from_slice(&bytes);
        }
    }
    encoded
}

/// Decodes what [`encode`] wrote.
pub fn decode(encoded: &[u8]) -> Answer {
    let unknown = || "its converter returned an invalid answer".to_owned();
    let (&kind, rest) = encoded.split_first().ok_or_else(unknown)?;
    if kind != CONVERTED {
        return Err(String::from_utf8_lossy(rest).into_owned());
    }
    let (length, rest) = rest.split_first_chunk().ok_or_else(unknown)?;
    let (warnings, bytes) = rest.split_at_checked(u32::from_le_bytes(*length) as usize).ok_or_else(unknown)?;
    let warnings = warnings.split_inclusive(|&byte| byte == 0).map(|warning| &warning[..warning.len() - 1]);
    let warnings = warnings.map(|warning| String::from_utf8_lossy(warning).into_owned()).collect();
    Ok(Output { bytes: bytes.to_vec(), warnings })
}

/// The memory through which a module is called. A fresh instance is made for each call.
#[derive(Debug, Default)]
pub struct Exchange {
    input: Mutex<Vec<u8>>,
    output: Mutex<Vec<u8>>,
}

fn locked(bytes: &Mutex<Vec<u8>>) -> MutexGuard<'_, Vec<u8>> {
    bytes.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Exchange {
    /// Creates empty memory.
    pub const fn new() -> Self {
        Self { input: Mutex::new(Vec::new()), output: Mutex::new(Vec::new()) }
    }

    /// Makes room for `length` bytes of input and returns where they belong.
    pub fn input(&self, length: usize) -> *mut u8 {
        let mut input = locked(&self.input);
        input.resize(length, 0);
        input.as_mut_ptr()
    }

    /// Converts the input. A panic leaves its message and place as the output.
    pub fn run(&'static self, convert: fn(&[u8]) -> Answer) {
        #[cfg(target_arch = "wasm32")]
        std::panic::set_hook(Box::new(|info| {
            let message = info.payload_as_str().unwrap_or("unknown error");
            let place = info.location().map(|place| format!(", {place}")).unwrap_or_default();
            *locked(&self.output) = format!("{message}{place}").into_bytes();
        }));
        *locked(&self.output) = encode(convert(&locked(&self.input)));
    }

    /// Returns where the encoded answer is, and its length in bytes.
    pub fn output(&self) -> (*const u8, usize) {
        let output = locked(&self.output);
        (output.as_ptr(), output.len())
    }
}

/// Turns a function `fn(&[u8]) -> Answer` into a program: a module with the exports that the crate's documentation
/// describes. Natively, the program runs [`pipe`] instead.
#[macro_export]
macro_rules! module {
    ($convert:path) => {
        static EXCHANGE: $crate::Exchange = $crate::Exchange::new();

        // The attribute is unsafe because another function of the same name may exist; here there is none.
        /// Makes room for `length` bytes of input.
        #[unsafe(no_mangle)]
        pub extern "C" fn input(length: usize) -> *mut u8 {
            EXCHANGE.input(length)
        }

        /// Converts the input.
        #[unsafe(no_mangle)]
        pub extern "C" fn run() {
            EXCHANGE.run($convert);
        }

        /// Where the encoded answer is.
        #[unsafe(no_mangle)]
        pub extern "C" fn output() -> *const u8 {
            EXCHANGE.output().0
        }

        /// Length of the encoded answer in bytes.
        #[unsafe(no_mangle)]
        pub extern "C" fn output_length() -> usize {
            EXCHANGE.output().1
        }

        #[cfg(target_arch = "wasm32")]
        fn main() {}

        #[cfg(not(target_arch = "wasm32"))]
        fn main() -> std::io::Result<()> {
            $crate::pipe($convert)
        }
    };
}

/// Converts standard input and writes the encoded answer to standard output, so that tests can compare it with the
/// module's.
///
/// # Errors
/// If the input cannot be read or the answer cannot be written.
pub fn pipe(convert: fn(&[u8]) -> Answer) -> io::Result<()> {
    let mut input = Vec::new();
    io::stdin().read_to_end(&mut input)?;
    io::stdout().write_all(&encode(convert(&input)))
}

/// Takes little-endian numbers off the front of a message; `None` if it is too short.
pub fn words<const COUNT: usize>(bytes: &mut &[u8]) -> Option<[u32; COUNT]> {
    let words = bytes.split_off(..4 * COUNT)?.as_chunks::<4>().0;
    Some(std::array::from_fn(|at| u32::from_le_bytes(words[at])))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_survive_encoding() {
        let warnings = vec!["no light".to_owned(), String::new(), "ä".to_owned()];
        for answer in [
            Ok(Output::default()),
            Ok(Output { bytes: vec![0, 1, 255], warnings }),
            Err("expected a mesh, found none".to_owned()),
        ] {
            assert_eq!(decode(&encode(answer.clone())), answer);
        }
    }

    #[test]
    fn damaged_answers_are_errors() {
        for encoded in [&[][..], &[CONVERTED, 1], &[CONVERTED, 9, 0, 0, 0, 1]] {
            assert!(decode(encoded).is_err());
        }
    }

    #[test]
    fn a_module_is_called_through_its_memory() {
        static EXCHANGE: Exchange = Exchange::new();
        EXCHANGE.input(3);
        EXCHANGE.run(|input| Ok(Output { bytes: input.to_vec(), warnings: Vec::new() }));
        assert_eq!(EXCHANGE.output().1, 1 + 4 + 3);
    }
}
