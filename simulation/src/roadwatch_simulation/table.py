"""Reads one table of a description strictly: keys known, values of their kind, every mistake noted."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any


class Mistakes(list):
    """What is wrong in a file, in order; each says where."""

    def add(self, where: str, what: str) -> None:
        """Notes a mistake at a place such as `[environment] kind`."""
        self.append(f"{where}: {what}")


class Table:
    """A table being read. `where` names it in messages; values that are wrong are noted and replaced."""

    def __init__(self, values: Any, where: str, mistakes: Mistakes, known: Sequence[str]) -> None:
        self.where = where
        self.mistakes = mistakes
        if not isinstance(values, dict):
            mistakes.add(where or "file", f"has to be a table, not {_kind(values)}")
            values = {}
        self._values = values
        for key in values:
            if key not in known:
                self.wrong(key, f"unknown key; known: {', '.join(known)}")

    def __contains__(self, key: str) -> bool:
        return key in self._values

    def raw(self, key: str) -> Any:
        """The value as it stands, or None."""
        return self._values.get(key)

    def wrong(self, key: str, what: str) -> None:
        """Notes a mistake of one key."""
        self.mistakes.add(f"{self.where} {key}".strip(), what)

    def number(
        self, key: str, default: float | None = None, *, least: float = -math.inf, most: float = math.inf
    ) -> float:
        """A finite number within bounds; without a default it has to be there."""
        value = self._values.get(key, default)
        if value is None:
            self.wrong(key, "missing")
            return max(least, 0.0)
        if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
            self.wrong(key, f"has to be a number, not {_kind(value)}")
            return default if default is not None else max(least, 0.0)
        if not least <= value <= most:
            self.wrong(key, f"is {value}; {_bounds(least, most)}")
            return default if default is not None else max(least, 0.0)
        return float(value)

    def integer(self, key: str, default: int | None = None, *, least: int = 0, most: int = 1 << 62) -> int:
        """A whole number within bounds."""
        value = self._values.get(key, default)
        if value is not None and (isinstance(value, bool) or not isinstance(value, int)):
            self.wrong(key, f"has to be a whole number, not {_kind(value)}")
            return default if default is not None else least
        return int(self.number(key, default, least=least, most=most))

    def text(self, key: str, default: str | None = None, *, among: Sequence[str] | None = None) -> str:
        """A string, one of `among` where that is given."""
        value = self._values.get(key, default)
        if value is None:
            self.wrong(key, "missing" if among is None else f"missing; one of {', '.join(among)}")
        elif not isinstance(value, str):
            self.wrong(key, f"has to be a string, not {_kind(value)}")
        elif among is not None and value not in among:
            self.wrong(key, f"`{value}` does not exist; there are {', '.join(among)}")
        else:
            return value
        return default if default is not None else (among[0] if among else "")

    def numbers(
        self, key: str, count: int, default: tuple[float, ...] | None = None
    ) -> tuple[float, ...] | None:
        """A list of so many finite numbers; None where it is missing and the default is None."""
        value = self._values.get(key)
        if value is None:
            return default
        fits = isinstance(value, list) and len(value) == count
        if not fits or not all(_is_number(item) for item in value):
            self.wrong(key, f"has to be a list of {count} numbers")
            return default
        return tuple(float(item) for item in value)

    def tables(self, key: str) -> list[Any]:
        """A list of tables, empty where it is missing."""
        value = self._values.get(key, [])
        if not isinstance(value, list):
            self.wrong(key, f"has to be a list of tables, not {_kind(value)}")
            return []
        return value


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def _bounds(least: float, most: float) -> str:
    if most == math.inf or most >= 1 << 62:
        return f"it has to be {least:g} or more"
    return f"it has to be between {least:g} and {most:g}"


def _kind(value: Any) -> str:
    if isinstance(value, bool):
        return "true or false"
    names = {str: "a string", int: "a number", float: "a number", list: "a list", dict: "a table"}
    return f"`{value}`" if isinstance(value, float | int) else names.get(type(value), "that")
