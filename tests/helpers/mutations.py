"""Files damaged as disks, networks and editors damage them: seeded, for every reader."""

import re
from collections.abc import Callable, Iterator

import numpy as np

Mutation = Callable[[bytes, np.random.Generator], bytes]

_LENGTHS = (1, 2, 4, 8, 64, 512)
_NUMBERS = (
    b"0",
    b"-1",
    b"1e999",
    b"nan",
    b"-inf",
    b"1e20",
    b"999999999",
    b"99999999999999999999",
    b"0.5",
    b"",
)
_NUMBER = re.compile(rb"[-+]?\d+\.?\d*(?:[eE][-+]?\d+)?")


def _region(content: bytes, rng: np.random.Generator) -> tuple[int, int]:
    """Begin and end of a piece."""
    begin = int(rng.integers(max(1, len(content))))
    return begin, begin + int(rng.choice(_LENGTHS))


def flipped(content: bytes, rng: np.random.Generator) -> bytes:
    """One to eight bits turned over."""
    found = bytearray(content)
    for _ in range(int(rng.integers(1, 9)) if found else 0):
        found[int(rng.integers(len(found)))] ^= 1 << int(rng.integers(8))
    return bytes(found)


def truncated(content: bytes, rng: np.random.Generator) -> bytes:
    """Cut off anywhere."""
    return content[: int(rng.integers(len(content) + 1))]


def zeroed(content: bytes, rng: np.random.Generator) -> bytes:
    """A piece of zeros, as a disk leaves that lost a sector."""
    begin, end = _region(content, rng)
    return content[:begin] + bytes(len(content[begin:end])) + content[end:]


def noisy(content: bytes, rng: np.random.Generator) -> bytes:
    """A piece of random bytes."""
    begin, end = _region(content, rng)
    return content[:begin] + rng.bytes(len(content[begin:end])) + content[end:]


def doubled(content: bytes, rng: np.random.Generator) -> bytes:
    """A piece that stands there twice."""
    begin, end = _region(content, rng)
    return content[:end] + content[begin:]


def removed(content: bytes, rng: np.random.Generator) -> bytes:
    """A piece that is missing."""
    begin, end = _region(content, rng)
    return content[:begin] + content[end:]


def swapped(content: bytes, rng: np.random.Generator) -> bytes:
    """A piece that stands in the place of another one."""
    begin, end = _region(content, rng)
    other, _ = _region(content, rng)
    return content[:begin] + content[other : other + end - begin] + content[end:]


def renumbered(content: bytes, rng: np.random.Generator) -> bytes:
    """A number, or the four or eight bytes of one, replaced by an unlikely one."""
    numbers = list(_NUMBER.finditer(content))
    if numbers and rng.random() < 0.7:
        match = numbers[int(rng.integers(len(numbers)))]
        return content[: match.start()] + bytes(rng.choice(_NUMBERS)) + content[match.end() :]
    begin = int(rng.integers(max(1, len(content) - 8)))
    size = int(rng.choice((4, 8)))
    value = int(rng.choice((0, 1, 2**31 - 1, -1, 2**30)))
    return content[:begin] + value.to_bytes(size, "little", signed=True) + content[begin + size :]


MUTATIONS: dict[str, Mutation] = {
    each.__name__: each for each in (flipped, truncated, zeroed, noisy, doubled, removed, swapped, renumbered)
}


def mutated(content: bytes, seed: int, count: int) -> Iterator[tuple[str, bytes]]:
    """Damaged copies of a file's content, of all kinds in turn; one in four is damaged twice.

    Parameters
    ----------
    content : bytes
        The sound file.
    seed : int
        The same seed gives the same copies.
    count : int
        How many.

    Yields
    ------
    kind : str
        What was done, such as `flipped` or `zeroed, removed`.
    content : bytes
        The damaged file.
    """
    rng = np.random.default_rng(seed)
    names = list(MUTATIONS)
    for i in range(count):
        kinds = [names[i % len(names)]]
        if rng.random() < 0.25:
            kinds.append(str(rng.choice(names)))
        found = content
        for kind in kinds:
            found = MUTATIONS[kind](found, rng)
        yield ", ".join(kinds), found
