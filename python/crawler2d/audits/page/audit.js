// The page of an audit: the runs over one obstacle side by side.

const made = new Map(); // the scenes of each obstacle that was looked at

function choose(number) {
  for (const each of document.querySelectorAll(".runs")) each.hidden = each.id !== `replay-${number}`;
  element("obstacle").value = number;
  if (!made.has(number)) {
    const runs = JSON.parse(element(`runs-${number}`).textContent);
    made.set(number, scenesOf(runs, element(`replay-${number}`).querySelectorAll("canvas")));
  }
  show(made.get(number));
}

// The way to a replay shows it.
function follow() {
  const number = /^#replay-(\d+)$/.exec(location.hash)?.[1];
  if (!number || !element(`runs-${number}`)) return false;
  choose(number);
  element("stage").scrollIntoView();
  element("play").focus({ preventScroll: true });
  return true;
}

function main() {
  element("obstacle").addEventListener("change", (event) => choose(event.target.value));
  for (const link of document.querySelectorAll('a[href^="#replay-"]')) {
    link.addEventListener("click", () => setTimeout(follow));
  }
  addEventListener("hashchange", follow);
  listen();
  if (!follow()) choose("0");
}

if (element("runs-0")) main();
