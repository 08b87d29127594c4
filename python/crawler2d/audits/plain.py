"""An audit as plain data, for JSON: no number that JSON does not have."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from crawler2d.audits.words import made
from crawler2d.parameters.plain import to_plain

if TYPE_CHECKING:
    from crawler2d.audits.audited import Audited

__all__ = ["plain_of"]


def plain_of(audit: Audited) -> dict[str, Any]:
    """Return lint, pockets, verdicts and repairs; what is infinite or unknown is None."""
    read = audit.reading
    plain: dict[str, Any] = _finite(
        {
            "robot": to_plain(audit.robot),
            "file": None if read is None else read.tree.file,
            "engine": None if read is None else read.engine,
            "friction": None if read is None else read.friction,
            "sources": None if read is None else dict(read.sources),
            "vary": audit.table.attrs["vary"],
            "unknown": audit.table.attrs["unknown"],
            "runs": made(audit.table),
            "belt": audit.belt.reason,
            "lint": [dataclasses.asdict(each) for each in audit.lint],
            "pockets": [dataclasses.asdict(each) for each in audit.pockets],
            "obstacles": {name: to_plain(each) for name, each in audit.obstacles.items()},
            "verdicts": [dataclasses.asdict(each) for each in audit.verdicts],
            "assumed": [
                {
                    **{f.name: getattr(each, f.name) for f in dataclasses.fields(each)},
                    "drawn": {path: str(range_) for path, range_ in each.drawn.items()},
                    "holds": each.holds,
                }
                for each in audit.assumed
            ],
            "repairs": [
                {
                    **{f.name: getattr(each, f.name) for f in dataclasses.fields(each)},
                    "robot": to_plain(each.robot),
                    "cleared": {k: dataclasses.asdict(v) for k, v in each.cleared.items()},
                    "seized": {k: dataclasses.asdict(v) for k, v in each.seized.items()},
                    "seized_at": {
                        k: {speed: dataclasses.asdict(v) for speed, v in own.items()}
                        for k, own in each.seized_at.items()
                    },
                    "cleared_beside": {
                        k: dataclasses.asdict(v) for k, v in each.cleared_beside.items()
                    },
                }
                for each in audit.repairs
            ],
            "seizes": audit.seizes,
        }
    )
    return plain


def _finite(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(key): _finite(each) for key, each in value.items()}
    if isinstance(value, (list, tuple)):
        return [_finite(each) for each in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
