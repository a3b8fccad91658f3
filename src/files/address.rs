//! URLs as people copy them: a GitHub page about a file is replaced by the raw file, which other pages are allowed to read.

use std::borrow::Cow;

const PAGES: &str = "github.com";
const RAW: &str = "https://raw.githubusercontent.com";
const GISTS: &str = "gist.github.com";
const RAW_GISTS: &str = "https://gist.githubusercontent.com";

/// Returns the raw URL of the file that a GitHub page shows; any other URL is returned unchanged. Branch names with slashes
/// work too, since the raw URL has the same path. A gist without a file name gives its first file.
pub fn raw_address(url: &str) -> Cow<'_, str> {
    raw_of_page(url).map_or(Cow::Borrowed(url), Cow::Owned)
}

fn raw_of_page(url: &str) -> Option<String> {
    let (scheme, rest) = url.trim().split_once("://")?;
    if !scheme.eq_ignore_ascii_case("https") && !scheme.eq_ignore_ascii_case("http") {
        return None;
    }
    // Query and fragment (raw=true, a line, a token) refer to the page.
    let rest = rest.split(['?', '#']).next()?;
    let (host, path) = rest.split_once('/')?;
    let host = host.to_ascii_lowercase();
    let parts: Vec<&str> = path.trim_end_matches('/').split('/').collect();
    match (host.strip_prefix("www.").unwrap_or(&host), parts.as_slice()) {
        (PAGES, [owner, repository, "blob" | "raw" | "blame", file @ ..]) if file.len() >= 2 => {
            Some(format!("{RAW}/{owner}/{repository}/{}", file.join("/")))
        }
        (GISTS, [owner, gist]) if is_gist(gist) => Some(format!("{RAW_GISTS}/{owner}/{gist}/raw")),
        (GISTS, [owner, gist, "raw", file @ ..]) if is_gist(gist) => {
            let file = file.iter().map(|part| format!("/{part}")).collect::<String>();
            Some(format!("{RAW_GISTS}/{owner}/{gist}/raw{file}"))
        }
        _ => None,
    }
}

fn is_gist(word: &str) -> bool {
    word.len() >= 20 && word.bytes().all(|byte| byte.is_ascii_hexdigit())
}
