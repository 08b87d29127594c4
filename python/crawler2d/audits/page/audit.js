"use strict";
(() => {
  const read = (id) => JSON.parse(document.getElementById(id).textContent);

  // A replay is made when its box is opened, and ends when that is closed.
  const fill = (box) => {
    for (const place of box.querySelectorAll("[data-replay]")) {
      const [before, between, after] = read(place.dataset.replay);
      const frame = document.createElement("iframe");
      frame.title = place.dataset.title;
      frame.sandbox = "allow-scripts";
      frame.srcdoc = before + read("replay-style") + between + read("replay-script") + after;
      place.replaceChildren(frame);
    }
  };
  for (const box of document.querySelectorAll("details.replay")) {
    box.addEventListener("toggle", () => {
      if (box.open) fill(box);
      else for (const place of box.querySelectorAll("[data-replay]")) place.replaceChildren();
    });
  }

  // The way to a replay opens it.
  const follow = () => {
    const target = document.getElementById(location.hash.slice(1));
    if (!target?.matches("details.replay")) return;
    target.open = true;
    target.querySelector("summary").focus({ preventScroll: true });
    target.scrollIntoView();
  };
  addEventListener("hashchange", follow);
  for (const link of document.querySelectorAll('a[href^="#replay-"]')) {
    link.addEventListener("click", () => setTimeout(follow));
  }
  follow();
})();
