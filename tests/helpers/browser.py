"""A headless Chromium that a test drives over its debugging protocol, and what it asked the network for."""

from __future__ import annotations

import asyncio
import json
import shutil
import subprocess
from base64 import b64decode
from collections.abc import Callable
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

FLAGS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--enable-unsafe-swiftshader",
    "--use-angle=swiftshader",
    "--hide-scrollbars",
    "--window-size=900,640",
    "--remote-debugging-port=0",
)
SECONDS = 60.0
DRAWN = "window.flexarm !== undefined"
Tab = Callable[..., Any]

needs_chromium = pytest.mark.skipif(shutil.which("chromium") is None, reason="needs Chromium")


class Page:
    """An open page: `run` evaluates JavaScript, `picture` returns pixels; `requests` and `errors` it made."""

    def __init__(self, connection: Any) -> None:
        self.connection, self.number = connection, 0
        self.requests: list[str] = []
        self.errors: list[str] = []

    async def call(self, method: str, **parameters: Any) -> dict[str, Any]:
        self.number += 1
        await self.connection.write_message(
            json.dumps({"id": self.number, "method": method, "params": parameters})
        )
        while True:
            message = json.loads(await asyncio.wait_for(self.connection.read_message(), SECONDS))
            if message.get("id") == self.number:
                assert "error" not in message, message
                return message["result"]
            self._note(message)

    def _note(self, message: dict[str, Any]) -> None:
        told = message.get("params", {})
        if message["method"] == "Network.requestWillBeSent":
            self.requests.append(told["request"]["url"])
        elif message["method"] == "Network.webSocketCreated":
            self.requests.append(told["url"])
        elif message["method"] == "Runtime.exceptionThrown":
            details = told["exceptionDetails"]
            self.errors.append(details.get("exception", {}).get("description", details["text"]))

    async def run(self, script: str) -> Any:
        found = await self.call("Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True)
        assert "exceptionDetails" not in found, found
        return found["result"].get("value")

    async def picture(self) -> NDArray[np.float64]:
        """Return the pixels, shape (height, width, 3), 0 to 1, once what was asked for is drawn."""
        from matplotlib.image import imread

        await self.run("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
        shot = await self.call("Page.captureScreenshot", format="png")
        return np.asarray(imread(BytesIO(b64decode(shot["data"])))[..., :3], dtype=float)


def visit(
    file: Path, profile: Path, look: Callable[[Page], Any], fragment: str = "", ready: str = DRAWN
) -> Page:
    """Open a file in Chromium, wait until it is loaded, and let `look` do the rest."""
    command = ["chromium", *FLAGS, f"--user-data-dir={profile}", "about:blank"]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        return asyncio.run(_visited(file.as_uri() + fragment, profile / "DevToolsActivePort", look, ready))
    finally:
        process.terminate()
        process.wait(SECONDS)


async def _visited(address: str, told: Path, look: Callable[[Page], Any], ready: str) -> Page:
    from tornado.httpclient import AsyncHTTPClient
    from tornado.websocket import websocket_connect

    for _ in range(int(10 * SECONDS)):
        if told.exists() and told.read_text().count("\n"):
            break
        await asyncio.sleep(0.1)
    port = told.read_text().split()[0]
    listed = await AsyncHTTPClient().fetch(f"http://127.0.0.1:{port}/json/list")
    tab = next(each for each in json.loads(listed.body) if each["type"] == "page")
    connection = await websocket_connect(tab["webSocketDebuggerUrl"], max_message_size=2**26)
    page = Page(connection)
    try:
        for domain in ("Network", "Runtime", "Page"):
            await page.call(f"{domain}.enable")
        await page.call("Page.navigate", url=address)
        for _ in range(int(10 * SECONDS)):
            if await page.run(f"document.readyState === 'complete' && ({ready})"):
                break
            await asyncio.sleep(0.1)
        await look(page)
    finally:
        connection.close()
    return page
