"""A small run, a sweep with its store and an audit, for each odd environment.

Called with a folder for its files, the number of an open descriptor for its answer, and what to do
besides the run and the sweep.
"""

import json
import os
import sys
from typing import Any


def work(folder: str, more: str) -> dict[str, Any]:
    if "audit" not in more:
        sys.modules["dask"] = None  # type: ignore[assignment] # its import takes longest
    import crawler2d as c2d  # noqa: PLC0415 - may fail, and then says so

    robot = c2d.robots.engineer(flippers=None).without_rotors()
    base = c2d.Scenario(robot, c2d.terrains.step(0.05), duration=2.0)
    run = c2d.simulate(base)
    answer: dict[str, Any] = {"position": [x.hex() for x in run.position[-1].tolist()]}
    store = os.path.join(folder, "store.sqlite")
    tracks = {"belt": c2d.BeltTrack(), "line of 3": c2d.LineOfWheels(3)}
    over: Any = {"robot.track": tracks}
    vary = c2d.variability.of_start()
    table = c2d.sweep(base, over, vary=vary, repeats=3, store=store)
    answer["outcomes"] = table["outcome"].values.tolist()
    answer["final_x"] = [x.hex() for x in table["final_x"].values.ravel().tolist()]
    answer["damage"] = list(c2d.check_store(store))
    saved = c2d.load(run.save(os.path.join(folder, "run.npz")))
    answer["saved"] = bool((saved.position == run.position).all())
    if "audit" in more:
        obstacles = {"step": c2d.terrains.step(0.05)}
        model = c2d.samples.path()
        found = c2d.audit(model, obstacles, samples=2, repeats=2, repair=False, quick=True)
        answer["audit"] = str(found)
    return answer


def main(folder: str, descriptor: str, *more: str) -> None:
    try:
        answer = work(folder, " ".join(more))
    except Exception as error:
        answer = {"error": f"{type(error).__name__}: {error}"}
    os.write(int(descriptor), json.dumps(answer).encode("ascii"))


if __name__ == "__main__":
    main(*sys.argv[1:])
