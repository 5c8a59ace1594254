#!/usr/bin/env python3
"""Opens a report in headless Chromium and looks: nothing on the console, no request but files, as many points as
report.json has, the right picture behind a click.

  browse_report.py REPORT [SCREENSHOT]    exits 77 where there is no Chromium
"""
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request

OPTIONS = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
           "--disable-component-update", "--disable-sync", "--window-size=1500,1700"]


class Browser:
    """chromedriver speaks the WebDriver protocol: JSON over HTTP."""

    def __init__(self, folder):
        self.driver = subprocess.Popen(["chromedriver", "--port=0"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        port = None
        for line in self.driver.stdout:
            if "on port " in line and "successfully" in line:
                port = int("".join(c for c in line.rsplit("on port ", 1)[1] if c.isdigit()))
                break
        if port is None:
            raise RuntimeError("chromedriver did not start")
        self.base = f"http://127.0.0.1:{port}"
        self.opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))
        capabilities = {"browserName": "chrome", "goog:loggingPrefs": {"browser": "ALL", "performance": "ALL"},
                        "goog:chromeOptions": {"args": [*OPTIONS, f"--user-data-dir={folder}"]}}
        made = self.call("POST", "/session", {"capabilities": {"alwaysMatch": capabilities}})
        self.base += "/session/" + made["sessionId"]

    def call(self, method, path, body=None):
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(self.base + path, data, {"Content-Type": "application/json"}, method=method)
        try:
            with self.opener.open(request, timeout=60) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            raise RuntimeError(error.read().decode()) from error

    def run(self, script, *arguments):
        return self.call("POST", "/execute/sync", {"script": script, "args": list(arguments)})

    def log(self, kind):
        return self.call("POST", "/se/log", {"type": kind})

    def click(self, x, y):
        pointer = {"type": "pointer", "id": "mouse", "actions": [
            {"type": "pointerMove", "duration": 0, "x": round(x), "y": round(y)},
            {"type": "pointerDown", "button": 0}, {"type": "pointerUp", "button": 0}]}
        self.call("POST", "/actions", {"actions": [pointer]})

    def screenshot(self, path):
        import base64
        with open(path, "wb") as file:
            file.write(base64.b64decode(self.call("GET", "/screenshot")))

    def close(self):
        self.driver.terminate()
        self.driver.wait(timeout=20)


# Where the plots' points are, in the window, with the key behind each.
PLACES = """
const chart = window.loom_charts[arguments[0]];
chart.canvas.scrollIntoView({block: "center"});
const box = chart.canvas.getBoundingClientRect();
return chart.getDatasetMeta(0).data.map((dot, i) => ({x: box.x + dot.x, y: box.y + dot.y,
  key: chart.data.datasets[0].data[i].point.key}));
"""
SHOWN = """
const detail = document.getElementById("detail");
return {open: detail.open, key: detail.dataset.key,
  pictures: [...detail.querySelectorAll("img")].map(i => [i.src, i.complete ? i.naturalWidth : 0])};
"""


def check(condition, what):
    if not condition:
        raise AssertionError(what)


def clear_of_others(place, places):
    """A dot under another would open that one."""
    return all(other is place or abs(other["x"] - place["x"]) + abs(other["y"] - place["y"]) > 20 for other in places)


def visit(browser, folder, screenshot):
    report = json.load(open(os.path.join(folder, "report.json"), encoding="utf-8"))
    browser.call("POST", "/url", {"url": "file://" + os.path.abspath(os.path.join(folder, "index.html"))})
    if screenshot:
        browser.screenshot(screenshot)
    charts = browser.run("return window.loom_charts.length")
    flickers = {p["scene"] for p in report["points"] if (p.get("flicker") or 0) > 0}
    check(charts == len(report["scenes"]) + len(flickers), f"{charts} plots")
    chart = clicks = 0
    for scene in report["scenes"]:
        points = {p["key"]: p for p in report["points"] if p["scene"] == scene["name"] and "error" in p}
        places = browser.run(PLACES, chart)
        check({p["key"] for p in places} == set(points) and len(places) == len(points),
              f"{len(places)} points of {scene['name']} are drawn, {len(points)} were measured")
        for place in [p for p in places if clear_of_others(p, places)][:3]:
            browser.run("document.getElementById('detail').close()")
            browser.click(place["x"], place["y"])
            time.sleep(.3)
            shown = browser.run(SHOWN)
            check(shown["open"] and shown["key"] == place["key"], f"a click on {place['key']} opened {shown['key']}")
            sources = [source for source, _ in shown["pictures"]]
            for wanted in (points[place["key"]]["picture"], scene["picture"], points[place["key"]]["heatmap"]):
                check(any(source.endswith("/" + wanted) for source in sources), f"{wanted} is not shown")
            check(all(width == scene["size"][0] for _, width in shown["pictures"]), f"pictures {shown['pictures']}")
            clicks += 1
        if screenshot:
            browser.screenshot(screenshot.replace(".png", f".{chart}.png"))
        browser.run("document.getElementById('detail').close()")
        chart += 1 + (scene["name"] in flickers)
    check(clicks > 0, "no point could be clicked")
    # Another cost and error, all colours: the page draws itself again.
    drawn = browser.run("""
      for (const [id, value] of [["cost", "cpu"], ["error", "indirect"]]) {
        const select = document.getElementById(id); select.value = value; select.onchange(); }
      document.querySelector("#pipelines button").click();
      return window.loom_charts[0].getDatasetMeta(0).data.length""")
    check(drawn > 0, "nothing is drawn of another error")

    console = [entry for entry in browser.log("browser") if entry["level"] in ("SEVERE", "WARNING")]
    check(not console, f"on the console: {console}")
    events = [json.loads(entry["message"])["message"] for entry in browser.log("performance")]
    # The browser's own first page is not the report's doing.
    urls = {e["params"]["request"]["url"] for e in events if e["method"] == "Network.requestWillBeSent"
            and not e["params"]["documentURL"].startswith("chrome://")}
    check(any(url.endswith("/report.js") for url in urls), "requests are not seen")
    elsewhere = sorted(url for url in urls if not url.startswith(("file://", "data:")))
    check(not elsewhere, f"requests to {elsewhere}")
    print(f"{charts} plots, {clicks} clicks, {len(urls)} files read, nothing asked of anybody")


def main():
    if not (shutil.which("chromedriver") and shutil.which("chromium")):
        print("there is no chromium with chromedriver: apt-get install chromium chromium-driver")
        return 77
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        browser = Browser(profile)
        try:
            visit(browser, sys.argv[1], sys.argv[2] if len(sys.argv) > 2 else None)
        except AssertionError as error:
            print("report:", error)
            return 1
        finally:
            try:
                browser.call("DELETE", "")
            finally:
                browser.close()
    return 0


if __name__ == "__main__":
    sys.exit(main())
