//! Time limits for futures.

use std::future::Future;

use futures_util::future::{Either, select};
use js_sys::Promise;
use wasm_bindgen_futures::JsFuture;

/// Awaits a future for some time, and returns it if it takes longer.
pub async fn within<F: Future + Unpin>(task: F, millis: i32) -> Result<F::Output, F> {
    let window = web_sys::window();
    let mut timer = None;
    let limit = Promise::new(&mut |resolve, _| {
        let start = |window: &web_sys::Window| {
            window.set_timeout_with_callback_and_timeout_and_arguments_0(&resolve, millis).ok()
        };
        timer = window.as_ref().and_then(start);
    });
    let outcome = match select(task, JsFuture::from(limit)).await {
        Either::Left((done, _)) => Ok(done),
        Either::Right((_, task)) => Err(task),
    };
    if let (Some(window), Some(timer)) = (window, timer) {
        window.clear_timeout_with_handle(timer);
    }
    outcome
}
