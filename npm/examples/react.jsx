// React 19 or later. With TypeScript, add: import type {} from "gaitway/react";
import { useRef, useState } from "react";
import { GaitwayViewer } from "gaitway";

GaitwayViewer.base = "/gaitway/";

export function Character() {
  const viewer = useRef(null);
  const [clip, setClip] = useState("run");
  return (
    <>
      <gaitway-viewer ref={viewer} model="sample:pilot" clip={clip} controls alt="A pilot" onload={() => console.log("shown")} />
      <button onClick={() => setClip(clip === "run" ? "idle" : "run")}>{clip}</button>
      <button onClick={() => viewer.current.pause()}>Pause</button>
    </>
  );
}
