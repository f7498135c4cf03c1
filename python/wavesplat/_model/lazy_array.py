"""Arrays whose samples are read when they are asked for (to be replaced)."""
from __future__ import annotations
from dataclasses import dataclass
from typing import Any, Protocol
import numpy as np
from wavesplat._model.facts import Facts

class LazyArray(Protocol):
    shape: tuple[int,int,int]
    dtype: Any
    chunks: tuple[int,int,int]
    is_in_memory: bool
    n_readers: int
    name: str
    token: str | None
    def read(self, lo, hi): ...
    def read_many(self, boxes): ...

@dataclass
class LazyTaken:
    levels: list
    world_from_index: Any
    facts: Facts
    name: str | None

class Sliced:
    def __init__(self, array, name="array", token=None):
        self.array = array; self.shape=tuple(array.shape); self.dtype=np.dtype(array.dtype)
        self.chunks=tuple(getattr(array,"chunks",None) or (min(32,n) for n in self.shape)); self.name=name; self.token=token
        self.is_in_memory=isinstance(array,np.ndarray); self.n_readers=4
    def read(self, lo, hi):
        return np.ascontiguousarray(self.array[tuple(slice(a,b) for a,b in zip(lo,hi))])
    def read_many(self, boxes):
        return [self.read(*b) for b in boxes]

def lazy_array(thing, *, argument="samples"):
    if isinstance(thing, list):
        return LazyTaken([lazy_array(t).levels[0] for t in thing], None, Facts(), None)
    if hasattr(thing, "read_many"):
        return LazyTaken([thing], None, Facts(), None)
    return LazyTaken([Sliced(thing)], None, Facts(), None)
