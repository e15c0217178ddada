"""A headless Chromium with one page, driven over the Chrome DevTools Protocol through a pipe."""

import atexit
import base64
import contextlib
import json
import os
import select
import shutil
import signal
import subprocess
import tempfile
import time

# The browser reads commands from descriptor 3 and writes replies to 4.
RUN = ("sh", "-c", 'exec "$@" 3<&0 4>&1 </dev/null >&2', "sh")
FLAGS = (
    "--headless=new --no-sandbox --disable-dev-shm-usage --disable-gpu --disable-breakpad"
    " --no-first-run --no-startup-window --remote-debugging-pipe"
).split()
# Windows' codes of keys that type nothing; Chromium goes by these.
KEY_CODES = {"ArrowLeft": 37, "ArrowUp": 38, "ArrowRight": 39, "ArrowDown": 40}


class BrowserError(Exception):
    """A command failed, a script threw, or the browser or its page has ended."""


class Browser:
    """Runs until close(). Positions are (x, y) in the window [CSS px]."""

    def __init__(self, program, timeout_s=60):
        self.events = []  # messages that are no replies, oldest first
        self._timeout_s = timeout_s  # of each command
        self._unread, self._last_id, self._session, self._pressed = b"", 0, {}, False
        self._profile = tempfile.mkdtemp(prefix="headless_browser_")
        self._log = open(os.path.join(self._profile, "log"), "w+b")
        self._process = subprocess.Popen(
            [*RUN, program, *FLAGS, "--user-data-dir=" + self._profile],
            bufsize=0,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._log,
            start_new_session=True,  # so that close() can end all that the browser has started
        )
        self._to, self._from = self._process.stdin.fileno(), self._process.stdout.fileno()
        os.set_blocking(self._to, False)
        atexit.register(self.close)
        try:
            page = self.command("Target.createTarget", url="about:blank")
            self._session = self.command("Target.attachToTarget", flatten=True, **page)
            for domain in ("Inspector", "Log", "Network", "Page", "Runtime"):
                self.command(domain + ".enable")
            self.command("Page.setLifecycleEventsEnabled", enabled=True)
        except BaseException:
            self.close()
            raise

    def close(self):
        atexit.unregister(self.close)
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self._process.pid, signal.SIGKILL)
        self._process.wait(self._timeout_s)
        for file in (self._process.stdin, self._process.stdout, self._log):
            file.close()
        # A process that is being killed may still be at its last write.
        deadline = time.monotonic() + self._timeout_s
        while os.path.exists(self._profile) and time.monotonic() < deadline:
            shutil.rmtree(self._profile, ignore_errors=True)

    def command(self, name, **parameters):
        """Returns the result."""
        self._deadline = time.monotonic() + self._timeout_s
        sent, reply = self._send(name, parameters), {}
        while reply.get("id") != sent:
            reply = self._receive("answer " + name)
        if "error" in reply:
            raise BrowserError(f"{name}: {reply['error']}")
        return reply["result"]

    def evaluate(self, body, *arguments):
        """Returns what a JavaScript function with this body returns, or its promise resolves to."""
        function = f"(function() {{{body}\n}}).apply(null, {json.dumps(arguments)})"
        reply = self.command(
            "Runtime.evaluate", expression=function, awaitPromise=True, returnByValue=True
        )
        if "exceptionDetails" in reply:
            raise BrowserError(f"{body}: {reply['exceptionDetails']}")
        return reply["result"].get("value")

    def open(self, url):
        """Returns when the page has loaded."""
        reply = self.command("Page.navigate", url=url)
        if "errorText" in reply:
            raise BrowserError(f"{url}: {reply['errorText']}")
        loaded = {"name": "load", "loaderId": reply["loaderId"]}
        while not any(loaded.items() <= event["params"].items() for event in self.events):
            self._receive("load " + url)

    def screenshot(self, path):
        """Saves what the window shows as PNG; returns that in base64."""
        png = self.command("Page.captureScreenshot", format="png")["data"]
        with open(path, "wb") as file:
            file.write(base64.b64decode(png))
        return png

    def press(self, *keys):
        """Presses keys one by one, each a character or one of KEY_CODES."""
        for key in keys:
            what = {"windowsVirtualKeyCode": KEY_CODES[key]} if key in KEY_CODES else {"text": key}
            self.command("Input.dispatchKeyEvent", type="keyDown", key=key, **what)
            self.command("Input.dispatchKeyEvent", type="keyUp", key=key)

    def mouse(self, kind, at, **more):
        """Of kind Moved, Pressed, Released or Wheel; the button is the left one."""
        held = {"Pressed": True, "Released": False}
        button = "left" if self._pressed or kind in held else "none"
        self._pressed = held.get(kind, self._pressed)
        more.update(x=at[0], y=at[1], button=button, buttons=int(self._pressed))
        self.command("Input.dispatchMouseEvent", type="mouse" + kind, **more)

    def click(self, at, times=1):
        self.mouse("Moved", at)
        for count in range(1, times + 1):
            self.mouse("Pressed", at, clickCount=count)
            self.mouse("Released", at, clickCount=count)

    def drag(self, start, end, num_steps=10):
        self.mouse("Moved", start)
        self.mouse("Pressed", start, clickCount=1)
        for step in range(1, num_steps + 1):
            self.mouse("Moved", [a + (b - a) * step / num_steps for a, b in zip(start, end)])
        self.mouse("Released", end, clickCount=1)

    def touch(self, kind, *points):
        """Of kind Start, Move or End; points are those that touch then."""
        points = [{"x": x, "y": y, "id": number} for number, (x, y) in enumerate(points)]
        self.command("Input.dispatchTouchEvent", type="touch" + kind, touchPoints=points)

    def _send(self, name, parameters):
        """Returns the id that the reply will have."""
        self._last_id += 1
        message = {"id": self._last_id, "method": name, "params": parameters, **self._session}
        data = json.dumps(message).encode() + b"\0"
        while data:
            self._wait([], [self._to], "take " + name)
            try:
                data = data[os.write(self._to, data) :]
            except BrokenPipeError:  # _receive() says why.
                break
        return self._last_id

    def _receive(self, what):
        """Returns the next message."""
        while b"\0" not in self._unread:
            self._wait([self._from], [], what)
            data = os.read(self._from, 1 << 20)
            if not data:
                self._log.seek(0)
                raise BrowserError(f"the browser has ended: {self._log.read()[-2000:]}")
            self._unread += data
        text, _, self._unread = self._unread.partition(b"\0")
        message = json.loads(text)
        if "method" in message:
            self.events.append(message)
        if message.get("method") == "Inspector.targetCrashed":
            raise BrowserError("the page has crashed")
        if message.get("method") == "Page.javascriptDialogOpening":  # The page waits for this.
            self._send("Page.handleJavaScriptDialog", {"accept": False})
        return message

    def _wait(self, readable, writable, what):
        left = max(self._deadline - time.monotonic(), 0)
        if not any(select.select(readable, writable, [], left)):
            raise TimeoutError(f"the browser did not {what} within {self._timeout_s} s")
