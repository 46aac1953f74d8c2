"""The daemon as a process: the program that ROADWATCH_BIN names, in a domain of its own, on loopback."""

import os
import random
import signal
import subprocess
import threading
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = Path(os.environ.get("ROADWATCH_BIN", ROOT / "target/release/roadwatch"))
# Where ./dev puts it.
ONNX_RUNTIME = ROOT / ".cache/onnxruntime/libonnxruntime.so"
DEMO = ROOT / "config/demo.toml"
CAMERAS = ["front_left", "front", "front_right", "right", "back", "left"]
# Each once. Up to 100, ports of domains are below those that Linux gives away by itself.
DOMAINS = iter(random.sample(range(1, 101), 100))
# More than a drained pipeline needs.
EXIT_SECONDS = 15


class Daemon:
    """Runs until it is stopped; what it says is kept."""

    def __init__(self, *arguments: str, config: Path = DEMO):
        self.domain = next(DOMAINS)
        environment = {
            "ORT_DYLIB_PATH": str(ONNX_RUNTIME),
            **os.environ,
            "ROS_DOMAIN_ID": str(self.domain),
            "ROS_LOCALHOST_ONLY": "1",
        }
        self.lines: list[str] = []
        self.process = subprocess.Popen(
            [PROGRAM, "run", config, "--loop", *arguments],
            env=environment,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
        )
        self.listener = threading.Thread(target=self.listen)
        self.listener.start()

    def listen(self) -> None:
        for line in self.process.stderr:
            self.lines.append(line.rstrip())

    def said(self, *words: str) -> list[str]:
        """Lines of its log with all of these words."""
        return [line for line in self.lines if all(word in line for word in words)]

    def is_running(self) -> bool:
        return self.process.poll() is None

    def exit_code(self) -> int:
        """Once it has ended; it must do so soon."""
        code = self.process.wait(EXIT_SECONDS)
        self.listener.join()
        return code

    def stop(self) -> int:
        """Ends it as Ctrl-C does, and gives its exit code."""
        if self.is_running():
            self.process.send_signal(signal.SIGINT)
        try:
            return self.exit_code()
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.exit_code()
            raise
