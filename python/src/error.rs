//! The exception of the package.

use gaitway::cli::functions::{Failure, Outcome};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyString;
use serde_json::Value;

pyo3::create_exception!(
    gaitway,
    Error,
    PyValueError,
    "What is wrong with a file, a joint map or an option, in the words of the command line.\n\n\
     The parts of the message are attributes; those that aren't known are None: `file`, `where` (a JSON path or a line),\n\
     `expected`, `found` and `hint`."
);

/// The attributes besides the message.
const PARTS: [&str; 5] = ["file", "where", "expected", "found", "hint"];

/// Turns a failure of the command line into an exception.
pub fn raised<T>(outcome: Outcome<T>) -> PyResult<T> {
    outcome.map_err(|failure| exception(&failure))
}

/// An exception about an argument.
pub fn argument_error(message: String) -> PyErr {
    exception(&Failure::from(message))
}

fn exception(failure: &Failure) -> PyErr {
    let document = serde_json::to_value(failure).unwrap_or_default();
    let error = Error::new_err(failure.message().to_owned());
    let set_parts = |py: Python<'_>| -> PyResult<()> {
        for part in PARTS {
            let text = document.get(part).and_then(Value::as_str);
            error.value(py).setattr(part, text.map(|text| PyString::new(py, text)))?;
        }
        Ok(())
    };
    match Python::attach(set_parts) {
        Ok(()) => error,
        Err(problem) => problem,
    }
}
