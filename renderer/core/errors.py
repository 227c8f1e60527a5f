"""Named errors. Every door turns them into a sentence; none reaches a user as a stack trace."""

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
        super().__init__(": ".join(part for part in (field, message) if part) + (f" (allowed: {allowed})" if allowed else ""))

    def as_dict(self) -> dict[str, str]:
        """The error as the doors send it."""
        return {"field": self.field, "message": self.message, "allowed": self.allowed}


class InvalidDocument(UmbrageError):
    """A state document was refused; `errors` names every offending field."""

    def __init__(self, errors: list[InputError]) -> None:
        self.errors = errors
        super().__init__("; ".join(str(error) for error in errors))


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
        super().__init__(f"{file}:{line}: {message}")


class Cancelled(UmbrageError):
    """Long work was cancelled by its owner."""
