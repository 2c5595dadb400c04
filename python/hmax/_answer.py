"""Answers that are JSON documents."""

from __future__ import annotations

from typing import Any, Dict, List


class Answer(Dict[str, Any]):
    """A JSON document of the program `hmax`, with its keys as attributes too.

    A number that may be unbounded is `math.inf` then, and a missing one None.
    """

    def __getattr__(self, name: str) -> Any:
        try:
            return self[name]
        except KeyError:
            raise AttributeError(f"the answer has no {name!r}; it has {', '.join(self)}") from None


def answer(document: Dict[str, Any]) -> Answer:
    """The same document with Answer for dict."""
    return Answer((key, _converted(value)) for key, value in document.items())


def answers(documents: List[Dict[str, Any]]) -> List[Answer]:
    """The same of a list of documents."""
    return [answer(document) for document in documents]


def _converted(value: Any) -> Any:
    if isinstance(value, dict):
        return answer(value)
    if isinstance(value, list):
        return [_converted(each) for each in value]
    return value
