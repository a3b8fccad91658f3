// What is different in a frame of the element `<gaitway-viewer>` (npm/viewer/gaitway.js). The element shows progress, its poster and
// errors, so the page doesn't show its own panels and dialogs for these. The address never changes, so that what is opened later
// adds no entries to the history of the page around the frame.
const options = new URLSearchParams(location.search);

/** Whether the element has made this frame. */
export const isViewer = parent !== window && options.has("viewer");

/** Whether the user may open files, by dropping or choosing them. */
export const allowsFiles = !isViewer || options.has("drop");

/** The parameters of the address that concern a frame or a machine, so links don't have them. */
export const OWN_PARAMETERS = ["renderer", "viewer", "drop"];

document.documentElement.classList.toggle("viewer", isViewer);
