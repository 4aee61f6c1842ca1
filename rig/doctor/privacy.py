"""What nobody needs to know in order to mend a bug: who you are, and which of a million adapters is yours."""

import getpass
import os
import platform
import re
import socket
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

HIDDEN = "(hidden)"
EVERYBODYS_NAMES = frozenset({"", "root", "user", "admin", "nobody", "localhost", "localdomain", "litrig", "rig", "pi"})
SHORTEST_NAME = 3
SHORTEST_KEPT_QUIET = 6
_KEPT_QUIET = r"token|secret|passw(?:or)?d|passphrase|api[_-]?key|access[_-]?key|private[_-]?key|credential|cookie"

_PATTERNS: tuple[tuple[re.Pattern[str], str], ...] = (
    # Names below /dev/serial/by-id and /dev/v4l/by-id end in the device's serial number and its interface.
    (
        re.compile(r"(/by-id/(?:usb-)?[^\s\"']*_)[^\s\"'_/]+?(-if\d\S*|-video-index\d+|-port\d+)?(?=[\s\"',;:)]|$)"),
        rf"\1{HIDDEN}\2",
    ),
    (re.compile(rf"(?i)\b({_KEPT_QUIET})([\"']?\s*[=:]\s*[\"']?)[^\s\"',;]+"), rf"\1\2{HIDDEN}"),
    (re.compile(r"(?i)\b(bearer|basic)\s+[A-Za-z0-9._~+/=-]{8,}"), rf"\1 {HIDDEN}"),
    (re.compile(r"\b(?:gh[pousr]_|github_pat_|glpat-|sk-|xox[a-z]-|AKIA|hf_)[A-Za-z0-9_-]{8,}"), HIDDEN),
    (re.compile(r"\beyJ[A-Za-z0-9_-]{6,}\.[A-Za-z0-9_-]+(?:\.[A-Za-z0-9_-]+)?"), HIDDEN),
    (re.compile(r"://[^/\s:@]+:[^/\s@]+@"), f"://{HIDDEN}@"),
    (re.compile(r"(?i)\b(serial(?:[ _-]?(?:no|nr|number))?\.?[\"']?\s*[=:]\s*[\"']?)[\w.-]{4,}"), rf"\1{HIDDEN}"),
    (re.compile(r"(/home/|/Users/|/media/|/run/media/|/run/user/)[^/\s\"':;,]+"), rf"\1{HIDDEN}"),
    (re.compile(r"[\w.+-]+@[\w-]+(?:\.[\w-]+)+"), HIDDEN),
    (re.compile(r"\b(?:[0-9A-Fa-f]{2}[:-]){5}[0-9A-Fa-f]{2}\b"), HIDDEN),
    (re.compile(r"\b(?:\d{1,3}\.){3}\d{1,3}\b"), HIDDEN),
    # What the owner of a controller stored in it, and what it tells of its network.
    (re.compile(r"(\[VER:[^:\]\r\n]*:)[^\]\r\n]*"), rf"\1{HIDDEN}"),
    (re.compile(r"\b((?:SSID|Hostname|IP|MAC)[=:])[^:\]\s]+"), rf"\1{HIDDEN}"),
)


class Mask:
    """Hides what is private in texts, and in whole structures of them."""

    def __init__(self, names: Iterable[str], homes: Iterable[str], secrets: Iterable[str]) -> None:
        """Say what is private.

        Parameters
        ----------
        names : of people and machines; hidden where they stand as words
        homes : folders that become `~`
        secrets : hidden wherever they stand
        """
        self._homes = sorted({home for home in homes if len(home) > 1}, key=len, reverse=True)
        self._secrets = sorted(
            {secret for secret in secrets if len(secret) >= SHORTEST_KEPT_QUIET}, key=len, reverse=True
        )
        words = {name for name in names if name.lower() not in EVERYBODYS_NAMES and len(name) >= SHORTEST_NAME}
        alternatives = "|".join(re.escape(word) for word in sorted(words, key=len, reverse=True))
        self._names = re.compile(rf"(?i)(?<![A-Za-z0-9])(?:{alternatives})(?![A-Za-z0-9])") if words else None

    @classmethod
    def of_this_machine(cls, environment: Mapping[str, str] = os.environ) -> "Mask":
        """Hide the user, the machine, and what the environment keeps secret."""
        variables = ("USER", "LOGNAME", "SUDO_USER", "USERNAME", "HOSTNAME", "NAME", "FULLNAME")
        names = {environment.get(key, "") for key in variables}
        homes = {str(Path.home()), environment.get("HOME", "")}
        names |= {platform.node(), platform.node().split(".")[0], socket.gethostname()}
        try:
            import pwd

            names.add(getpass.getuser())
            entry = pwd.getpwuid(os.getuid())
            full_name = entry.pw_gecos.split(",")[0].strip()
            names |= {entry.pw_name, full_name, *full_name.split()}
            homes.add(entry.pw_dir)
        except (KeyError, OSError):  # a user without an entry
            pass
        names |= {Path(home).name for home in homes}
        is_secret = re.compile(rf"(?i){_KEPT_QUIET}|(?:^|_)key(?:$|_)|auth")
        secrets = {value for key, value in environment.items() if is_secret.search(key)}
        return cls(names, homes, secrets)

    def text(self, text: str) -> str:
        """Hide what is private in a text."""
        for secret in self._secrets:
            text = text.replace(secret, HIDDEN)
        for home in self._homes:
            text = re.sub(rf"{re.escape(home)}(?=[/\s\"':;,)]|$)", "~", text)
        for pattern, instead in _PATTERNS:
            text = pattern.sub(instead, text)
        return text if self._names is None else self._names.sub(HIDDEN, text)

    def bytes(self, content: bytes) -> bytes:
        """Hide what is private in bytes that may be text; others stay as they are."""
        return self.text(content.decode("latin-1")).encode("latin-1")

    def structure(self, value: Any) -> Any:
        """Hide what is private in all texts of lists and tables; keys are ours, and stay."""
        if isinstance(value, Mapping):
            return {
                key: HIDDEN
                if isinstance(item, str) and re.search(rf"(?i){_KEPT_QUIET}|serial(?:_?n(?:o|r|umber))?$", str(key))
                else self.structure(item)
                for key, item in value.items()
            }
        if isinstance(value, list | tuple):
            return [self.structure(item) for item in value]
        return self.text(value) if isinstance(value, str) else value
