// The page of a run as a widget for notebooks, in a frame; another run gets its own frame.

function render({ model, el }) {
  const stack = document.createElement("div");
  stack.style.cssText = `position: relative; width: 100%; height: ${model.get("height")}px`;
  el.append(stack);
  const reported = () => stack.lastElementChild?.reported;
  let shown = null; // the page that is loading or loaded

  const show = () => {
    const frame = document.createElement("iframe");
    frame.sandbox = "allow-scripts"; // the page can reach neither the notebook nor the network
    frame.style.cssText = "position: absolute; inset: 0; width: 100%; height: 100%; border: 0; visibility: hidden";
    frame.addEventListener("load", () => {
      // The previous one stayed until now, to avoid flicker.
      while (frame.previousSibling) frame.previousSibling.remove();
      frame.style.visibility = "visible";
      frame.loaded = true;
      if (model.get("page") !== shown) show();
    });
    shown = frame.srcdoc = model.get("page");
    stack.append(frame);
  };

  // One at a time: while a slider moves, pages arrive faster than they load.
  const change = () => {
    if (stack.lastElementChild.loaded) show();
  };

  const seek = () => {
    const time = model.get("time");
    if (time !== reported()) stack.lastElementChild.contentWindow.postMessage({ crawler2d: time }, "*");
  };

  const hear = (event) => {
    const frame = stack.lastElementChild;
    const time = event.data?.crawler2d;
    if (event.source !== frame?.contentWindow || !Number.isFinite(time) || time === frame.reported) return;
    frame.reported = time;
    model.set("time", time);
    model.save_changes();
  };

  show();
  model.on("change:page", change);
  model.on("change:time", seek);
  window.addEventListener("message", hear);
  return () => window.removeEventListener("message", hear);
}

export default { render };
