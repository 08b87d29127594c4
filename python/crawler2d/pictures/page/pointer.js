// Mouse and touch on the side view: drag, wheel, pinch, double click.

function watchPointer(canvas, camera, changed, embedded) {
  const fingers = new Map();
  const place = (event) => {
    const box = canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, place(event));
    canvas.classList.add("dragged");
  });
  canvas.addEventListener("pointermove", (event) => {
    const before = fingers.get(event.pointerId);
    if (!before) return;
    const now = place(event);
    const other = [...fingers].find(([id]) => id !== event.pointerId)?.[1];
    fingers.set(event.pointerId, now);
    if (other) {
      const apart = (point) => Math.hypot(point[0] - other[0], point[1] - other[1]) || 1;
      camera.zoom(apart(now) / apart(before), other[0], other[1]);
    } else camera.drag(now[0] - before[0], now[1] - before[1]);
    changed();
  });
  const lift = (event) => {
    fingers.delete(event.pointerId);
    if (!fingers.size) canvas.classList.remove("dragged");
  };
  canvas.addEventListener("pointerup", lift);
  canvas.addEventListener("pointercancel", lift);
  canvas.addEventListener("dblclick", () => {
    camera.reset();
    changed();
  });
  canvas.addEventListener("wheel", (event) => {
    // In a page embedded in another one the wheel scrolls the outer page until the picture is clicked.
    if (embedded && document.activeElement !== canvas && !event.ctrlKey) return;
    event.preventDefault();
    const lines = event.deltaMode === 1 ? 16 : 1;
    const factor = Math.exp(-event.deltaY * lines * (event.ctrlKey ? 0.01 : 0.0015));
    camera.zoom(Math.min(2, Math.max(0.5, factor)), ...place(event));
    changed();
  }, { passive: false });
}
