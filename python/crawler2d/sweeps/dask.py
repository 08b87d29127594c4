"""Dask clusters as executors whose tasks always end."""

from __future__ import annotations

import contextlib
from concurrent.futures import Executor, Future, InvalidStateError
from typing import Any

__all__ = ["reliable"]


def reliable(executor: Executor) -> Executor:
    """Return a replacement for Dask's `client.get_executor()`; other executors unchanged.

    Dask's own never completes a task whose result was lost with its worker or in a restart of the
    cluster, unless recomputing it succeeds: the error is raised where nothing waits for it.
    """
    if type(executor).__module__ != "distributed.cfexecutor":
        return executor
    return _Cluster(vars(executor)["_client"])


class _Cluster(Executor):
    """Submits to a Dask client."""

    def __init__(self, client: Any) -> None:
        self._client = client

    def submit(self, call: Any, /, *args: Any, **options: Any) -> Future[Any]:
        """Submit a task; resubmitted tasks are computed again."""
        task = self._client.submit(call, *args, pure=False, **options)
        answer: Future[Any] = Future()

        def cancel(ended: Future[Any]) -> None:
            if ended.cancelled():
                task.cancel()

        answer.add_done_callback(cancel)
        self._client.loop.add_callback(_pass_on, task, answer)
        return answer


async def _pass_on(task: Any, answer: Future[Any]) -> None:
    """Forward the result of a task, unless nothing waits for it any longer."""
    with contextlib.suppress(InvalidStateError):
        try:
            answer.set_result(await task)
        except InvalidStateError:
            raise
        except BaseException as error:  # the other thread waits for any result
            answer.set_exception(error)
