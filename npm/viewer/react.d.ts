// The element in JSX: `import type {} from "gaitway/react"`.
import type { DetailedHTMLProps, HTMLAttributes } from "react";
import type { GaitwayViewer, ViewerAttributes, ViewerEvents } from "./gaitway.js";

/** React listens to an element's own events by their names in lower case. */
type Listeners = { [Type in keyof ViewerEvents as `on${Type}`]?: (event: ViewerEvents[Type]) => void };

declare module "react" {
  namespace JSX {
    interface IntrinsicElements {
      "gaitway-viewer": DetailedHTMLProps<HTMLAttributes<GaitwayViewer>, GaitwayViewer> & Partial<ViewerAttributes> & Listeners;
    }
  }
}
