"""A real headless Chromium, driven through WebDriver."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from selenium import webdriver
from selenium.webdriver.chrome.service import Service

ARGUMENTS = (
    *("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"),
    *("--disable-background-networking", "--disable-component-update", "--disable-sync"),
    *("--disable-dev-shm-usage", "--hide-scrollbars", "--force-device-scale-factor=1"),
)


@contextmanager
def chromium(profile: Path) -> Iterator[Any]:
    """Driver of a browser with an empty profile; skips the test where none can be had."""
    names = ("chromium", "chromium-browser", "google-chrome")
    browser = next((found for name in names if (found := shutil.which(name))), None)
    driver = shutil.which("chromedriver")
    if browser is None or driver is None:
        pytest.skip("no browser is here; install Chromium and its driver (Debian: chromium-driver)")
    options = webdriver.ChromeOptions()
    options.binary_location = browser
    for argument in (*ARGUMENTS, f"--user-data-dir={profile}"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    window = webdriver.Chrome(options=options, service=Service(driver))
    try:
        window.set_window_size(1280, 1000)
        yield window
    finally:
        window.quit()


def asked_for(window: Any) -> set[str]:
    """Addresses the page has asked for since the last call, besides data it holds itself."""
    messages = [json.loads(entry["message"])["message"] for entry in window.get_log("performance")]
    sent = [each for each in messages if each["method"] == "Network.requestWillBeSent"]
    urls = {each["params"]["request"]["url"] for each in sent}
    return {url for url in urls if not url.startswith("data:")}


def use_theme(window: Any, theme: str) -> None:
    """Let the system prefer `light` or `dark`."""
    feature = {"name": "prefers-color-scheme", "value": theme}
    window.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [feature]})
