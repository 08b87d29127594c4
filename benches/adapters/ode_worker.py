"""Open Dynamics Engine in a separate process: JSON lines in, JSON lines out.

It needs only the module `ode` and the standard library, so that any interpreter that has ODE runs
it: Debian builds it only for the system's Python. The constants of that module are older than the
library under it, so the library's own are here (`ode/common.h`, `ode/contact.h` of ODE 0.16).
"""

import json
import math
import signal
import sys
from typing import Any

import ode

_PARAM_VEL, _PARAM_FMAX = 2, 5
_SOFT_ERP, _SOFT_CFM, _APPROX1 = 0x008, 0x010, 0x7000
_MOST = 20  # contacts of two shapes, as in Gazebo classic


class World:
    """A robot on its ground.

    The message has `bodies` (see `rigid_bodies`), `ground`, `friction`, `x`, `z`, `angle`, `phase`
    and `setting`: `time_step` [s], `iterations`, `cfm`, `erp`, `layer` [m], `correcting` [m/s], and
    of contacts `soft_cfm` and `soft_erp`.
    """

    def __init__(self, message: dict[str, Any]) -> None:
        setting = message["setting"]
        self.step = setting["time_step"]
        self.world = ode.World()
        self.world.setGravity((0.0, 0.0, -9.81))
        self.world.setQuickStepNumIterations(setting["iterations"])
        self.world.setCFM(setting["cfm"])
        self.world.setERP(setting["erp"])
        self.world.setContactSurfaceLayer(setting["layer"])
        self.world.setContactMaxCorrectingVel(setting["correcting"])
        self.setting = setting
        self.friction = message["friction"]
        self.contacts = ode.JointGroup()
        self.ground = [self._block(each) for each in message["ground"]]
        self.start = [message["x"], 0.0, message["z"]]
        self.angle = message["angle"]
        self.shapes: list[tuple[Any, str]] = []
        self.touches: list[dict[str, Any]] = []
        self.bodies: list[Any] = []
        self.motors: list[tuple[Any, float]] = []
        self.center = [0.0, 0.0, 0.0]
        for data in message["bodies"]:
            self._body(data, message["phase"])

    def _block(self, data: dict[str, Any]) -> Any:
        block = ode.GeomBox(None, data["size"])
        block.setPosition(data["center"])
        cos, sin = math.cos(data["yaw"]), math.sin(data["yaw"])
        block.setRotation((cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0))
        return block

    def _body(self, data: dict[str, Any], phase: float) -> None:
        body, mass = ode.Body(self.world), ode.Mass()
        xx, xy, xz, _, yy, yz, _, _, zz = data["inertia"]
        mass.setParameters(data["mass"], 0.0, 0.0, 0.0, xx, yy, zz, xy, xz, yz)
        body.setMass(mass)
        center, axle = data["center"], data["axle"]
        turn = 0.0 if axle is None else phase / data["radius"]
        body.setPosition(self._placed(center if axle is None else _turned(center, axle, turn)))
        body.setRotation(_about_y(turn - self.angle))
        for shape in data["shapes"]:
            if shape["kind"] == "cylinder":
                geom = ode.GeomCylinder(None, shape["radius"], shape["length"])
            elif shape["kind"] == "box":
                geom = ode.GeomBox(None, shape["size"])
            else:
                raise ValueError(f"{shape['kind']}: ODE gets cylinders and boxes alone")
            geom.setBody(body)
            geom.setOffsetPosition([a - b for a, b in zip(shape["place"], center, strict=True)])
            geom.setOffsetRotation(shape["turn"])
            self.shapes.append((geom, data["name"]))
        self.bodies.append(body)
        if axle is None:
            self.center = center
            return
        hinge = ode.HingeJoint(self.world)
        # ODE has the rate of the first body relative to the second.
        hinge.attach(body, self.bodies[0])
        hinge.setAnchor(self._placed(axle))
        hinge.setAxis((0.0, 1.0, 0.0))
        hinge.setParam(_PARAM_FMAX, data["torque"])
        self.motors.append((hinge, data["radius"]))

    def _placed(self, point: list[float]) -> list[float]:
        """[m] Return the initial position of a point of the chassis frame."""
        turned = _turned(point, [0.0, 0.0, 0.0], -self.angle)
        return [a + b for a, b in zip(self.start, turned, strict=True)]

    def advance(self, speeds: list[float]) -> dict[str, list[float]]:
        """Take a step for each set-point [m/s]."""
        for speed in speeds:
            for hinge, radius in self.motors:
                hinge.setParam(_PARAM_VEL, speed / radius)
            self.contacts.empty()
            self._touch()
            self.world.quickStep(self.step)
        return self.pose()

    def _touch(self) -> None:
        self.touches = []
        for shape, name in self.shapes:
            low_x, high_x, low_y, high_y, low_z, _ = shape.getAABB()
            for block in self.ground:
                x0, x1, y0, y1, _, z1 = block.getAABB()
                if low_z > z1 or low_x > x1 or high_x < x0 or low_y > y1 or high_y < y0:
                    continue
                for contact in ode.collide(shape, block)[:_MOST]:
                    contact.setMode(_SOFT_ERP | _SOFT_CFM | _APPROX1)
                    contact.setMu(self.friction)
                    contact.setSoftERP(self.setting["soft_erp"])
                    contact.setSoftCFM(self.setting["soft_cfm"])
                    joint = ode.ContactJoint(self.world, self.contacts, contact)
                    joint.attach(shape.getBody(), None)
                    point, normal = contact.getContactGeomParams()[:2]
                    self.touches.append({"link": name, "point": point, "normal": normal})

    def pose(self) -> dict[str, list[float]]:
        """Return the position of the chassis frame, and its rotation row by row."""
        chassis = self.bodies[0]
        place, turn = chassis.getPosition(), chassis.getRotation()
        rows = [turn[0:3], turn[3:6], turn[6:9]]
        offset = [sum(a * b for a, b in zip(row, self.center, strict=True)) for row in rows]
        return {"place": [a - b for a, b in zip(place, offset, strict=True)], "turn": list(turn)}


def _about_y(angle: float) -> tuple[float, ...]:
    cos, sin = math.cos(angle), math.sin(angle)
    return cos, 0.0, sin, 0.0, 1.0, 0.0, -sin, 0.0, cos


def _turned(point: list[float], axle: list[float], angle: float) -> list[float]:
    """[m] Turn a point about an axle along y."""
    turn = _about_y(angle)
    arm = [a - b for a, b in zip(point, axle, strict=True)]
    rows = [turn[0:3], turn[3:6], turn[6:9]]
    return [
        at + sum(a * b for a, b in zip(row, arm, strict=True))
        for at, row in zip(axle, rows, strict=True)
    ]


def main() -> None:
    """Answer every line until there are no more."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # the parent process handles Ctrl-C
    world: World | None = None
    for line in sys.stdin:
        message = json.loads(line)
        if message["do"] == "build":
            world = World(message)
            answer: dict[str, Any] = world.pose()
        elif world is None:
            raise ValueError("nothing was built")
        elif message["do"] == "touches":
            answer = {"touches": world.touches}
        else:
            answer = world.advance(message["speeds"])
        sys.stdout.write(json.dumps(answer) + "\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main()
