"""Answers that are JSON documents."""

from __future__ import annotations

from typing import Any, Dict


class Answer(Dict[str, Any]):
    """A JSON document of the program `hmax`, with its keys as attributes too.

    A number that may be unbounded is `math.inf` then, and a missing one None.
    """

    def __getattr__(self, name: str) -> Any:
        try:
            return self[name]
        except KeyError:
            raise AttributeError(f"the answer has no {name!r}; it has {', '.join(self)}") from None


def answer(document: Any) -> Any:
    """The same document with Answer for dict."""
    if isinstance(document, dict):
        return Answer((key, answer(value)) for key, value in document.items())
    if isinstance(document, list):
        return [answer(value) for value in document]
    return document
