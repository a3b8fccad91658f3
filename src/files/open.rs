//! Opens a set of items: reads them, sorts them by content and decodes the images of the models.

use gaitway_scene::editor::Contents;
use gaitway_scene::library::Derived;

use super::read::{FilesRead, Item, read_items};
use super::sort::sort_noticing_images;
use super::source::{Progress, Source};
use super::{OpenError, Role, Sorted};

pub(super) async fn open_items<S: Source>(
    source: &S,
    items: Vec<Item>,
    role: Role,
    progress: Progress<'_>,
) -> Result<Contents, OpenError> {
    let read = read_items(source, items, progress).await?;
    open_read(source, read, role).await
}

/// Turns files in memory into contents.
pub(super) async fn open_read<S: Source>(source: &S, read: FilesRead, role: Role) -> Result<Contents, OpenError> {
    let FilesRead { set, samples, origins, .. } = read;
    // A sample is a model already, so none is required among the files.
    let role = if samples.is_empty() || role == Role::Motion { role } else { Role::Any };
    // The browser decodes on other threads while the rest is parsed here.
    let mut decoding: Vec<(String, S::Decoding)> = Vec::new();
    let mut sorted = if set.is_empty() && !samples.is_empty() {
        Sorted::default()
    } else {
        sort_noticing_images(&set, role, &mut |name, images| {
            if role != Role::Motion {
                decoding.push((name.to_owned(), source.start_decoding(images)));
            }
        })?
    };
    let is_only = sorted.models.len() + samples.len() == 1;
    let mut models = Vec::new();
    for (name, mut asset) in std::mem::take(&mut sorted.models) {
        let started = decoding.iter().position(|(of, _)| *of == name).map(|at| decoding.swap_remove(at).1);
        let started = started.unwrap_or_else(|| source.start_decoding(&asset.images));
        let derived = Derived::new(&asset);
        let images = source.finish_decoding(started, &mut asset, is_only).await;
        models.push(origins.model(&set, name, asset, derived, images));
    }
    Ok(origins.contents(&set, sorted, models, samples, role))
}
