"""Named errors. Every door turns them into a sentence; none reaches a user as a stack trace.

Each passes its arguments to `Exception` as they are, so that it survives the way back from a worker process.
"""

from __future__ import annotations


class UmbrageError(Exception):
    """Base of every error this project raises on purpose."""


class InputError(UmbrageError):
    """Outside input was refused.

    Args:
        field: dotted path of the offending field, as `shadow.softness` ("" when it is the whole document).
        message: one sentence saying what is wrong.
        allowed: the allowed values or range, in words ("" when there is none to give).
    """

    def __init__(self, field: str, message: str, allowed: str = "") -> None:
        self.field = field
        self.message = message
        self.allowed = allowed
        super().__init__(field, message, allowed)

    def __str__(self) -> str:
        sentence = ": ".join(part for part in (self.field, self.message) if part)
        return f"{sentence} (allowed: {self.allowed})" if self.allowed else sentence

    def at(self, field: str, silent: tuple[str, ...] = ("file", "asset")) -> InputError:
        """The same refusal where a document made it, as `terrain.asset`.

        Args:
            field: the document's field.
            silent: fields of a file's own that the sentence need not name, because `field` says as much.
        """
        own = self.field.rsplit(".", 1)[-1]
        named = own in silent or own == field.rsplit(".", 1)[-1]
        return type(self)(field, self.message if named else f"{own} {self.message}", self.allowed)

    def as_dict(self) -> dict[str, str]:
        """The error as the doors send it."""
        return {"field": self.field, "message": self.message, "allowed": self.allowed}


class InvalidDocument(UmbrageError):
    """A state document was refused; `errors` names every offending field."""

    def __init__(self, errors: list[InputError]) -> None:
        self.errors = errors
        super().__init__(errors)

    def __str__(self) -> str:
        return "; ".join(str(error) for error in self.errors)


class AssetError(InputError):
    """A user's file was refused."""


class LimitError(InputError):
    """A size, count or quota was exceeded."""


class GLThreadError(UmbrageError):
    """The GL context was touched from a thread that does not own it."""


class GLUnavailable(UmbrageError):
    """No usable OpenGL context, or a technique requires more than this machine has."""


class ShaderError(UmbrageError):
    """GLSL did not compile.

    Args:
        file: path of the source file, relative to the shader root.
        line: line in that file, counted from 1.
        message: the compiler's words.
    """

    def __init__(self, file: str, line: int, message: str) -> None:
        self.file = file
        self.line = line
        self.message = message
        super().__init__(file, line, message)

    def __str__(self) -> str:
        return f"{self.file}:{self.line}: {self.message}"


class Cancelled(UmbrageError):
    """Long work was cancelled by its owner."""
