"""Asks MuJoCo what a model is, as plain data; runs in a child process."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import PurePath
from typing import Any

from crawler2d.common.extras import extra
from crawler2d.errors import ScenarioError
from crawler2d.reading.child import no_more_files, serve
from crawler2d.reading.files import LARGEST_TOGETHER, Files, why

# MuJoCo numbers the kinds of joints and shapes; what is not here is refused by its number.
_JOINTS = {0: "free", 1: "ball", 2: "slide", 3: "hinge"}
_SHAPES = {0: "plane", 1: "hfield", 2: "sphere", 3: "capsule", 4: "ellipsoid", 5: "cylinder"}
_SHAPES |= {6: "box", 7: "mesh"}
_INTEGRATOR = 1  # the number of the dynamics of an actuator whose activation is a position


def prepare() -> Callable[[dict[str, Any]], dict[str, Any]]:
    """Import MuJoCo."""
    mujoco = extra("mujoco", "models")
    return lambda question: _described(mujoco, **question)


def _described(mujoco: Any, *, text: str, file: str, files: dict[str, Any]) -> dict[str, Any]:
    lacking: list[_Lacking] = []
    try:
        with no_more_files():
            spec = mujoco.MjSpec.from_string(text)
        _undress(spec)
        lacking = list(_hand_over(spec, Files(**files), file))
        with no_more_files():
            model = spec.compile()
    except ScenarioError:
        raise
    except Exception as error:  # MuJoCo has several classes of errors for a bad file
        if lacking:  # without it, perhaps nothing tells what a body weighs
            raise lacking[0].error from None
        said = " ".join(str(error).split())
        line = re.search(r"line (\d+)", said)
        at = f"{file}:{line[1]}" if line else file
        raise ScenarioError(at, said, "must be a model that MuJoCo compiles") from None
    return {
        "name": spec.modelname,
        "bodies": [_body(model, body) for body in spec.bodies],
        "joints": [_joint(model, joint) for joint in spec.joints],
        "shapes": [_shape(model, geom) for geom in spec.geoms],
        "motors": [_motor(model, actuator) for actuator in spec.actuators],
        "lacking": [each.plain for each in lacking],
    }


@dataclass(frozen=True, slots=True)
class _Lacking:
    """A geom that is left out, for its mesh or height map could not be read."""

    body: Any
    what: dict[str, Any]
    error: ScenarioError

    @property
    def plain(self) -> dict[str, Any]:
        return {"body": self.body.id, **self.what}


def _undress(spec: Any) -> None:
    """Take off what is only seen: its files need not be there, nor be read."""
    for material in spec.materials:
        material.textures = [""] * len(material.textures)
    for kind in (spec.textures, spec.skins):
        for item in list(kind):
            spec.delete(item)


def _hand_over(spec: Any, files: Files, file: str) -> Iterator[_Lacking]:
    """Read the meshes and height maps of a model, and give MuJoCo what they hold for their names.

    What cannot be read is taken off the model, with the geoms that it is the shape of.
    """
    folder, spec.meshdir = spec.meshdir, ""
    lowest, highest = spec.compiler.inertiagrouprange
    for kind, named in (("meshes", "meshname"), ("hfields", "hfieldname")):
        for item in list(getattr(spec, kind)):
            if not item.file:
                continue
            inner = PurePath(item.file).name if spec.strippath else item.file
            place = os.path.join(folder, inner)
            try:
                at = f"{file}:{_line(item)}: {kind}[{item.name}]"
                data = files.read(place, at=at, most=LARGEST_TOGETHER)
            except ScenarioError as error:
                for geom in list(spec.geoms):
                    if getattr(geom, named) == item.name:
                        body = geom.parent
                        weighs = not body.explicitinertial and lowest <= geom.group <= highest
                        what = {
                            "name": geom.name,
                            "file": place,
                            "reason": why(error),
                            "collides": bool(geom.contype or geom.conaffinity),
                            "weighs": bool(weighs and (geom.mass > 0.0 or geom.density > 0.0)),
                            "line": _line(geom),
                        }
                        spec.delete(geom)
                        yield _Lacking(body, what, error)
                spec.delete(item)
            else:
                item.file = f"{len(spec.assets)}{PurePath(item.file).suffix}"
                spec.assets[item.file] = data


def _line(item: Any) -> int:
    """Return the line that MuJoCo noted for an item of the file; 0 for what it added itself."""
    found = re.search(r"line (\d+)", item.info)
    return int(found[1]) if found else 0


def _body(model: Any, body: Any) -> dict[str, Any]:
    i = body.id
    return {
        "name": body.name or f"body {i}",
        "parent": int(model.body_parentid[i]),
        "place": model.body_pos[i].tolist(),
        "turn": model.body_quat[i].tolist(),
        "mass": float(model.body_mass[i]),
        "center": model.body_ipos[i].tolist(),
        "axes": model.body_iquat[i].tolist(),
        "inertia": model.body_inertia[i].tolist(),
        "line": _line(body),
    }


def _joint(model: Any, joint: Any) -> dict[str, Any]:
    i = joint.id
    limited = bool(model.jnt_limited[i])
    first = int(model.jnt_dofadr[i])  # the only one of hinges and slides
    return {
        "name": joint.name or f"joint {i}",
        "kind": _JOINTS.get(int(model.jnt_type[i]), "unknown"),
        "body": int(model.jnt_bodyid[i]),
        "place": model.jnt_pos[i].tolist(),
        "axis": model.jnt_axis[i].tolist(),
        "range": model.jnt_range[i].tolist() if limited else None,
        "stiffness": float(model.jnt_stiffness[i].flat[0]),
        "damping": float(model.dof_damping[first]),
        "friction": float(model.dof_frictionloss[first]),
        "armature": float(model.dof_armature[first]),
        "effort": float(model.jnt_actfrcrange[i, 1]) if model.jnt_actfrclimited[i] else None,
        "line": _line(joint),
    }


def _shape(model: Any, geom: Any) -> dict[str, Any]:
    i = geom.id
    kind = _SHAPES.get(int(model.geom_type[i]), "unknown")
    collides = bool(model.geom_contype[i] or model.geom_conaffinity[i])
    points = None
    if kind == "mesh" and collides:
        mesh = int(model.geom_dataid[i])
        first, count = int(model.mesh_vertadr[mesh]), int(model.mesh_vertnum[mesh])
        points = model.mesh_vert[first : first + count].tolist()
    return {
        "name": geom.name or f"geom {i}",
        "kind": kind,
        "body": int(model.geom_bodyid[i]),
        "place": model.geom_pos[i].tolist(),
        "turn": model.geom_quat[i].tolist(),
        "size": model.geom_size[i].tolist(),
        "points": points,
        # In one dimension, a contact has no friction.
        "friction": float(model.geom_friction[i, 0]) if model.geom_condim[i] > 1 else 0.0,
        "priority": int(model.geom_priority[i]),
        "collides": collides,
        "moved": geom.surfacevel.tolist() if hasattr(geom, "surfacevel") else [0.0] * 6,
        "line": _line(geom),
    }


def _motor(model: Any, actuator: Any) -> dict[str, Any]:
    """Return what an actuator can do at its joint; None where it has no limit."""
    i = actuator.id
    gear = abs(float(model.actuator_gear[i, 0]))
    gain, bias = float(model.actuator_gainprm[i, 0]), model.actuator_biasprm[i]
    most = float(model.actuator_ctrlrange[i, 1]) if model.actuator_ctrllimited[i] else None
    effort = None
    if model.actuator_forcelimited[i]:
        effort = float(model.actuator_forcerange[i, 1]) * gear
    elif most is not None and not bias.any():  # a motor: its force is its control
        effort = most * gain * gear
    # A servo of speed holds control / gear; one of position has a bias on the position, too, and
    # holds a speed if it integrates its control.
    is_integrator = int(model.actuator_dyntype[i]) == _INTEGRATOR
    is_of_speed = not is_integrator and bias[2] < 0.0 and bias[1] == 0.0
    is_servo = is_integrator or is_of_speed
    return {
        "joint": actuator.target,
        "effort": effort,
        "damping": float(model.actuator_damping[i]) * gear**2,
        "armature": float(model.actuator_armature[i]) * gear**2,
        "gain": -float(bias[2]) * gear**2 if is_of_speed else None,
        "velocity": most / gear if is_servo and most is not None and gear > 0.0 else None,
        "line": _line(actuator),
    }


if __name__ == "__main__":
    serve(prepare)
