// What is different in a frame that the element `<gaitway-viewer>` has made (npm/viewer/gaitway.js). The element shows progress, its
// poster and what went wrong, so the page's own panels and dialogs about that stay away. The address remains the one that the element
// gave: what is opened later must not become entries of the history around the frame.
const options = new URLSearchParams(location.search);

/** Whether the element has made this frame. */
export const isViewer = parent !== window && options.has("viewer");

/** Whether the user may open files, by dropping or choosing them. */
export const allowsFiles = !isViewer || options.has("drop");

/** The parameters of the address that concern a frame or a machine, so links don't have them. */
export const OWN_PARAMETERS = ["renderer", "viewer", "drop"];

document.documentElement.classList.toggle("viewer", isViewer);
