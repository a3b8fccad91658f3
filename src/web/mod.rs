//! The page: `window.gaitway` and the start of the app in the browser.
pub fn start() {}
