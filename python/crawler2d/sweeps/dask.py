"""Dask's clusters as executors whose every task comes to an end."""

from __future__ import annotations

import contextlib
from concurrent.futures import Executor, Future, InvalidStateError
from typing import Any

__all__ = ["reliable"]


def reliable(executor: Executor) -> Executor:
    """Return what to use in place of `client.get_executor()` of Dask; any other as it is.

    Dask's own never answers for a task whose result was lost with its worker, or by a restart of
    the cluster, unless computing it again succeeds: the error is raised where nobody listens.
    """
    if type(executor).__module__ != "distributed.cfexecutor":
        return executor
    return _Cluster(vars(executor)["_client"])


class _Cluster(Executor):
    """Submits to a client of Dask."""

    def __init__(self, client: Any) -> None:
        self._client = client

    def submit(self, call: Any, /, *args: Any, **options: Any) -> Future[Any]:
        """Submit a task; one that is submitted again is computed again."""
        task = self._client.submit(call, *args, pure=False, **options)
        answer: Future[Any] = Future()

        def cancel(ended: Future[Any]) -> None:
            if ended.cancelled():
                task.cancel()

        answer.add_done_callback(cancel)
        self._client.loop.add_callback(_pass_on, task, answer)
        return answer


async def _pass_on(task: Any, answer: Future[Any]) -> None:
    """Pass on how a task ends, unless nobody waits for it any longer."""
    with contextlib.suppress(InvalidStateError):
        try:
            answer.set_result(await task)
        except InvalidStateError:
            raise
        except BaseException as error:  # whatever it is, the other thread waits
            answer.set_exception(error)
