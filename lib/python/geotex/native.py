"""The C libraries of the wheel: loading them, errors, limits, memory. Internal."""

from __future__ import annotations

import enum
import os
from pathlib import Path
from typing import Any, Callable, Mapping, Optional, Union

import numpy as np

from ._declarations import ffi

Source = Union[str, "os.PathLike[str]", bytes, bytearray, memoryview]
Limits = Mapping[str, int]
ProgressFn = Callable[["Progress"], Any]

_folder = Path(__file__).resolve().parent / "lib"


class Result(enum.IntEnum):
    """What a call of the library ended in: `gtx_result` of geotex.h."""

    OK = 0
    CANCELLED = 1
    ARGUMENT = 10
    NOT_ZEROED = 11
    MEMORY = 20
    LIMIT = 21
    READ = 30
    WRITE = 31
    NOT_GTX = 40
    VERSION = 41
    TRUNCATED = 42
    CORRUPT = 43
    UNSUPPORTED = 45
    INPUT = 60
    EMPTY = 61
    GL = 80
    SHADER = 81
    INTERNAL = 99


class Error(Exception):
    """What the library refused, and why.

    code:      the Result; name is its name, such as "LIMIT"
    limit:     with LIMIT, the key of `limits` that would raise it, such as "memory"; else None
    rule:      number of the broken rule of format/gtx.md, 0 when none applies; rule_name its name
    offset:    the byte of the file that broke it
    """

    def __init__(self, message: str, code: Result, limit: Optional[str] = None, rule: int = 0,
                 rule_name: Optional[str] = None, offset: int = 0) -> None:
        super().__init__(message)
        self.code, self.limit = code, limit
        self.rule, self.rule_name, self.offset = rule, rule_name, offset

    @property
    def name(self) -> str:
        return self.code.name

    def __str__(self) -> str:
        label = f"{self.name}, rule {self.rule} {self.rule_name}" if self.rule else self.name
        return f"[{label}] {self.args[0]}"

    def __reduce__(self) -> Any:
        return (Error, (self.args[0], self.code, self.limit, self.rule, self.rule_name,
                        self.offset))


class Cancelled(Error):
    """A progress function asked to stop."""


def _load(name: str) -> Any:
    try:
        return ffi.dlopen(str(_folder / name))
    except OSError as why:
        raise Error(f"{name} cannot be loaded: {why}. It needs the packages of Debian 12 that "
                    "libopenmesh1, libdraco7, libmeshoptimizer2d and libzstd1 are",
                    Result.UNSUPPORTED) from None


core: Any = _load("libgeotex.so")
_process: Any = ffi.dlopen(None)
_cook: Any = None


def cook_library() -> Any:
    """The cooker, which is loaded when it is first asked for."""
    global _cook
    if _cook is None:
        _cook = _load("libgeotex-cook.so")
    return _cook


def free(memory: Any) -> None:
    """Gives back what the library took with malloc."""
    _process.free(memory)


def version() -> str:
    """The version of the C library, such as "0.1.0"."""
    number = core.gtx_version()
    return f"{number // 10000}.{number // 100 % 100}.{number % 100}"


def text_of(pointer: Any) -> Optional[str]:
    return ffi.string(pointer).decode("utf-8", "replace") if pointer else None


def new_error() -> Any:
    return ffi.new("gtx_error *")


def check(result: int, error: Any = None) -> None:
    """Raises what `result` says, with the words of `error`, a gtx_error that the call got."""
    if result == Result.OK:
        return
    code = Result(result)
    words = text_of(core.gtx_result_string(result)) or code.name
    if error is None or error.result != result:
        raise (Cancelled if code is Result.CANCELLED else Error)(words, code)
    message = text_of(error.message) or words
    if code is Result.CANCELLED:
        raise Cancelled(message, code)
    raise Error(message, code, text_of(error.limit), error.rule, text_of(error.rule_name),
                error.offset)


def path_of(path: Union[str, "os.PathLike[str]"]) -> bytes:
    """A path as C takes it."""
    name = os.fsencode(path)
    if b"\0" in name:
        raise ValueError("a path with a zero byte")
    return name


def is_path(source: Source) -> bool:
    return isinstance(source, (str, os.PathLike))


def bytes_of(source: Source) -> Any:
    """What C reads the bytes from; keeps `source` alive, and is not copied."""
    return ffi.from_buffer(memoryview(source))  # type: ignore[arg-type]


def fill_limits(struct: Any, limits: Optional[Limits]) -> None:
    for name, value in (limits or {}).items():
        if name == "reserved" or not hasattr(struct, name):
            raise TypeError(f"there is no limit {name!r}")
        setattr(struct, name, value)


def fill(struct: Any, options: Mapping[str, Any]) -> None:
    """Sets the fields of a descriptor: zero asks for a field's default."""
    for name, value in options.items():
        setattr(struct, name, value)


def choose(number_of: Mapping[str, int], what: str, name: str) -> int:
    if name not in number_of:
        raise ValueError(f"{what} is one of {', '.join(number_of)}, not {name!r}")
    return number_of[name]


class Memory:
    """Memory of the library as an array: numpy keeps this object, and so `owner`, as its base."""

    def __init__(self, pointer: Any, dtype: Any, shape: tuple, owner: Any) -> None:
        kind = np.dtype(dtype)
        self.owner = owner
        self.__array_interface__ = {
            "version": 3, "shape": shape, "typestr": kind.str, "descr": kind.descr,
            "data": (int(ffi.cast("uintptr_t", pointer)), True)}


def array_of(pointer: Any, dtype: Any, shape: tuple, owner: Any) -> np.ndarray:
    """A read-only array of what `pointer` points to; not copied."""
    if 0 in shape:
        return np.empty(shape, dtype)
    return np.asarray(Memory(pointer, dtype, shape, owner))


class Progress:
    """How far a call has come: `stage` of `stage_count`, such as "bake", and `fraction`, 0..1."""

    __slots__ = ("stage", "stage_index", "stage_count", "fraction")

    def __init__(self, told: Any) -> None:
        self.stage = text_of(told.stage) or ""
        self.stage_index, self.stage_count = told.stage_index, told.stage_count
        self.fraction: float = told.fraction


class Watch:
    """Calls `progress` from a long call, and ends the call where it raises, returns True or the
    user interrupts. `with Watch(desc, progress) as watch: watch.check(call(...), error)`."""

    def __init__(self, desc: Any, progress: Optional[ProgressFn]) -> None:
        self.progress = progress
        self.raised: Optional[BaseException] = None
        # Without a function too: Python handles signals, such as Ctrl-C, when its code runs.
        self.callback = ffi.callback("gtx_progress_fn", self._tell, error=1, onerror=self._keep)
        desc.progress = self.callback

    def _tell(self, told: Any, _user: Any) -> int:
        return 1 if self.progress and self.progress(Progress(told)) is True else 0

    def _keep(self, _kind: Any, raised: BaseException, _trace: Any) -> None:
        self.raised = raised

    def check(self, result: int, error: Any) -> None:
        if self.raised is not None:
            raise self.raised
        check(result, error)
