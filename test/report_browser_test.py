"""Opens a run's report.html in a headless Chromium, as a user does from a folder.

Usage: report_browser_test.py PROGRAMS_DIR WORLD_FILE OUTPUT_DIR
Exit code 77: skipped, since no browser is installed.
"""

import math
import os
import re
import shutil
import subprocess
import sys
import unittest

sys.dont_write_bytecode = True  # not beside the sources
from headless_browser import Browser

SKIPPED = 77
BROWSERS = ("chromium-headless-shell", "chromium", "chromium-browser")
BROWSER = next(filter(None, map(shutil.which, BROWSERS)), None)
if not BROWSER:
    print("SKIPPED: chromium-headless-shell is not installed")
    sys.exit(SKIPPED)

PROGRAMS, WORLD, OUTPUT = sys.argv[1:4]
# A name that would run a script if the report did not escape it.
LOG = os.path.join(OUTPUT, "<img src=x onerror=alert(1)>.clf")
REPORT = os.path.join(OUTPUT, "run", "report.html")
DESKTOP, PHONE = (1280, 900), (360, 740)


def make_report():
    shutil.rmtree(OUTPUT, ignore_errors=True)
    os.makedirs(OUTPUT)
    truth = ["--truth=" + OUTPUT + "/truth.tum", "--hits=" + OUTPUT + "/hits.txt"]
    for command in (
        ["plumbline_simulate", "--world=" + WORLD, "--log=" + LOG] + truth,
        ["plumbline_slam", "--log=" + LOG, "--output_dir=" + OUTPUT + "/run", "--measure_rounds"]
        + truth,
    ):
        subprocess.run(
            [os.path.join(PROGRAMS, command[0])] + command[1:],
            check=True,
            stdout=subprocess.DEVNULL,
        )


def is_error(event):
    """Whether it is an error in the console, or a dialog."""
    method, what = event["method"], event["params"]
    return (
        method in ("Runtime.exceptionThrown", "Page.javascriptDialogOpening")
        or (method == "Log.entryAdded" and what["entry"]["level"] == "error")
        or (method == "Runtime.consoleAPICalled" and what["type"] in ("error", "assert"))
    )


class ReportTest(unittest.TestCase):
    maxDiff = None  # Errors are shown in full.

    @classmethod
    def setUpClass(cls):
        make_report()
        cls.browser = Browser(BROWSER)
        cls.addClassCleanup(cls.browser.close)

    def setUp(self):
        self.open(DESKTOP)

    def tearDown(self):
        self.script("")  # The page replies after it has sent its events.
        errors = list(filter(is_error, self.browser.events))
        self.browser.events.clear()
        self.assertEqual(errors, [])

    def open(self, size, scheme="light"):
        self.browser.command(
            "Emulation.setDeviceMetricsOverride",
            width=size[0],
            height=size[1],
            deviceScaleFactor=1,
            mobile=size == PHONE,
        )
        self.browser.command(
            "Emulation.setEmulatedMedia",
            features=[{"name": "prefers-color-scheme", "value": scheme}],
        )
        self.browser.open("file://" + REPORT)
        self.script("return Promise.all([...document.images].map((image) => image.decode()))")
        self.scroll_to("#stage")

    def script(self, body, *arguments):
        return self.browser.evaluate(body, *arguments)

    def texts(self, selector):
        """Texts of the elements that are shown."""
        return self.script(
            """return [...document.querySelectorAll(arguments[0])]
                .filter((e) => e.checkVisibility({checkOpacity: true, checkVisibilityCSS: true}))
                .map((e) => (e.innerText ?? e.textContent).trim())""",
            selector,
        )

    def text(self, selector):
        return " ".join(self.texts(selector))

    def attributes(self, selector, name):
        return self.script(
            """return [...document.querySelectorAll(arguments[0])]
                .map((e) => e.getAttribute(arguments[1]))""",
            selector,
            name,
        )

    def scroll_to(self, selector):
        self.script(
            "document.querySelector(arguments[0]).scrollIntoView({block: 'center'})", selector
        )

    def center(self, selector, index=0):
        """Where in the window an element has its centre [CSS px]."""
        return self.script(
            """const box = document.querySelectorAll(arguments[0])[arguments[1]]
                .getBoundingClientRect();
            return [box.x + box.width / 2, box.y + box.height / 2]""",
            selector,
            index,
        )

    def beside_center(self, selector, right, down):
        x, y = self.center(selector)
        return x + right, y + down

    def click(self, selector):
        self.script(
            "document.querySelector(arguments[0]).scrollIntoView({block: 'nearest'})", selector
        )
        at = self.center(selector)
        is_on_top = """const [selector, [x, y]] = arguments;
            return document.querySelector(selector).contains(document.elementFromPoint(x, y))"""
        self.assertTrue(self.script(is_on_top, selector, at), selector)
        self.browser.click(at)

    def press(self, selector, *keys):
        self.script("document.querySelector(arguments[0]).focus()", selector)
        self.browser.press(*keys)

    def layer(self, name):
        """Transform and clip of a map as shown."""
        style = self.script(
            "const s = document.querySelector(`img[data-name=${arguments[0]}]`).style;"
            "return [s.transform, s.clipPath, s.visibility, s.imageRendering]",
            name,
        )
        return dict(zip(("transform", "clip", "visibility", "rendering"), style))

    def zoom_of(self, name):
        return float(re.search(r"scale\(([-.\de]+)\)", self.layer(name)["transform"]).group(1))

    def position(self):
        """World position under the mouse, as the viewer says [m]."""
        text = self.text("#position").replace("\u2212", "-")
        return [float(number) for number in re.findall(r"-?[\d.]+", text)]

    def divided_at(self):
        return float(self.script("return document.getElementById('divide').value"))

    def screenshot(self, name):
        """Saves what the window shows; returns its width and its number of colours."""
        png = self.browser.screenshot(os.path.join(OUTPUT, name + ".png"))
        return self.script(
            """const image = new Image();
            image.src = 'data:image/png;base64,' + arguments[0];
            return image.decode().then(() => {
              const canvas = document.createElement('canvas');
              [canvas.width, canvas.height] = [image.width, image.height];
              const context = canvas.getContext('2d');
              context.drawImage(image, 0, 0);
              const bytes = context.getImageData(0, 0, image.width, image.height).data;
              return [image.width, new Set(new Uint32Array(bytes.buffer)).size];
            });""",
            png,
        )

    def test_asks_for_nothing_but_itself(self):
        start = len(self.browser.events)
        self.open(DESKTOP)
        urls = [
            event["params"]["request"]["url"]
            for event in self.browser.events[start:]
            if event["method"] == "Network.requestWillBeSent"
        ]
        foreign = [url for url in urls if not url.startswith("data:")]
        self.assertEqual(len(foreign), 1, foreign)
        self.assertTrue(foreign[0].endswith("/run/report.html"))
        policy = self.attributes("meta[http-equiv=Content-Security-Policy]", "content")
        self.assertIn("default-src 'none'", policy[0])
        # The policy is in force: a picture from elsewhere is refused. It logs an error of its own.
        start = len(self.browser.events)
        refused = self.script(
            """return new Promise((done) => {
              document.addEventListener('securitypolicyviolation', () => done(true));
              const image = new Image();
              image.onload = () => done(false);
              setTimeout(() => done(false), 10000);
              image.src = 'http://127.0.0.1:9/x.png';
            })"""
        )
        self.assertTrue(refused)
        del self.browser.events[start:]

    def test_shows_texts_as_they_are(self):
        self.assertEqual(self.texts("h1"), [os.path.basename(LOG)])
        self.assertEqual(self.attributes("h1 img", "src"), [])

    def test_mouse_and_keys_move_the_divider(self):
        before = self.layer("Refined")["clip"], self.layer("Odometry")["clip"]
        self.assertEqual(self.divided_at(), 50)
        self.browser.drag(self.center("#divider"), self.beside_center("#divider", -200, 0))
        stage = self.script("return document.getElementById('stage').offsetWidth")
        self.assertAlmostEqual(self.divided_at(), 50 - 100 * 200 / stage, delta=1)
        after = self.layer("Refined")["clip"], self.layer("Odometry")["clip"]
        self.assertNotEqual(after[0], before[0])
        self.assertNotEqual(after[1], before[1])
        dragged_to = self.divided_at()
        self.press("#divide", "ArrowRight")
        self.assertGreater(self.divided_at(), dragged_to)
        self.assertNotEqual(self.layer("Refined")["clip"], after[0])

    def test_the_wheel_zooms_about_the_cursor(self):
        cursor = self.beside_center("#stage", 210, 60)
        self.browser.mouse("Moved", cursor)
        before, zoom = self.position(), self.zoom_of("Refined")
        self.browser.mouse("Wheel", cursor, deltaX=0, deltaY=-240)
        self.assertGreater(self.zoom_of("Refined"), 1.5 * zoom)
        for at, was in zip(self.position(), before):
            self.assertAlmostEqual(at, was, delta=0.03)

    def test_buttons_and_keys_zoom_and_reset(self):
        start, zoom = self.layer("Refined")["transform"], self.zoom_of("Refined")
        self.click("#zoom-in")
        self.assertAlmostEqual(self.zoom_of("Refined"), 1.5 * zoom, delta=1e-3 * zoom)
        self.click("#zoom-out")
        self.assertAlmostEqual(self.zoom_of("Refined"), zoom, delta=1e-3 * zoom)
        self.press("#stage", "+")
        self.assertAlmostEqual(self.zoom_of("Refined"), 1.5 * zoom, delta=1e-3 * zoom)
        self.press("#stage", "-")
        self.assertAlmostEqual(self.zoom_of("Refined"), zoom, delta=1e-3 * zoom)
        moved = self.layer("Refined")["transform"]
        self.press("#stage", "ArrowLeft")
        self.assertNotEqual(self.layer("Refined")["transform"], moved)
        self.press("#stage", "0")
        self.assertEqual(self.layer("Refined")["transform"], start)
        for _ in range(12):
            self.click("#zoom-in")
        self.assertEqual(self.layer("Refined")["rendering"], "pixelated")
        self.click("#zoom-reset")
        self.assertEqual(self.layer("Refined")["transform"], start)

    def test_dragging_takes_the_map_along(self):
        start = self.beside_center("#stage", 200, 50)
        end = self.beside_center("#stage", 280, 90)
        self.browser.mouse("Moved", start)
        before = self.position()
        self.browser.drag(start, end)
        for at, was in zip(self.position(), before):
            self.assertAlmostEqual(at, was, delta=0.03)
        zoom = self.zoom_of("Refined")
        self.browser.click(end, times=2)
        self.assertAlmostEqual(self.zoom_of("Refined"), 2 * zoom, delta=1e-3 * zoom)

    def test_other_maps_can_be_chosen(self):
        self.assertEqual(self.layer("Seed")["visibility"], "hidden")
        self.press("#map-left", *"Seed")  # A list chooses what is typed.
        self.assertEqual(self.layer("Seed")["visibility"], "visible")
        self.assertEqual(self.layer("Odometry")["visibility"], "hidden")

    def test_two_fingers_zoom(self):
        self.open(PHONE)
        width = self.script("return document.getElementById('stage').offsetWidth")
        x, y = self.beside_center("#stage", -0.25 * width, 0)
        zoom = self.zoom_of("Refined")
        touch = self.browser.touch
        touch("Start", (x - 20, y))
        touch("Start", (x - 20, y), (x + 20, y))
        for distance in range(20, 61, 5):
            touch("Move", (x - distance, y), (x + distance, y))
        touch("End")
        self.assertGreater(self.zoom_of("Refined"), 2 * zoom)
        for _ in range(2):
            touch("Start", (x, y))
            touch("End")
        self.assertGreater(self.zoom_of("Refined"), 4 * zoom)

    def test_charts_are_drawn_and_explain_themselves(self):
        plot = "[data-plot='0'] "
        self.scroll_to(plot)
        self.assertGreater(len(self.attributes(plot + "circle", "cy")), 2)
        self.browser.mouse("Moved", self.center(plot + "circle", 1))
        self.assertIn("energy", self.text(plot + ".tip"))
        self.assertEqual(self.texts(plot + "text.label"), ["seconds"])
        self.click("input[name=plot-0] ~ *, .switch label:last-child")
        self.assertEqual(self.texts(plot + "text.label"), ["iterations"])
        for number in self.attributes("[data-histogram]", "data-histogram"):
            bars = self.attributes(f"[data-histogram='{number}'] rect.bin", "height")
            heights = [float(height) for height in bars]
            self.assertGreater(max(heights), 100)
            self.assertTrue(all(math.isfinite(height) for height in heights))

    def test_errors_by_stage_fall(self):
        plot = "[data-stage-plot='0'] "
        self.scroll_to(plot)
        heights = [float(height) for height in self.attributes(plot + "circle", "cy")]
        self.assertEqual(len(heights) % 2, 0)  # of poses, then of the map
        self.assertLess(heights[0] + 50, heights[len(heights) // 2 - 1])
        self.browser.mouse("Moved", self.center(plot + "circle"))
        self.assertIn("odometry, pose", self.text(plot + ".tip"))

    def test_tables_need_no_scrolling_on_a_desktop(self):
        wider = """
            return [...document.querySelectorAll('section .scroll')]
                .filter((box) => box.scrollWidth > box.clientWidth)
                .map((box) => box.getAttribute('aria-label'))"""
        self.assertEqual(self.script(wider), [])

    def test_options_can_be_searched(self):
        self.click("#options summary")
        rows = ".options tbody tr"
        self.assertEqual(len(self.texts(rows)), len(self.attributes(rows, "class")))
        self.press("#option-search", *"sigma_range")
        shown = self.texts(rows)
        self.assertEqual(len(shown), 1)
        self.assertIn("sigma_range_m", shown[0])

    def test_looks_right_in_every_size_and_scheme(self):
        for name, size in (("desktop", DESKTOP), ("phone", PHONE)):
            for scheme, is_right in (("light", lambda x: x > 200), ("dark", lambda x: x < 60)):
                with self.subTest(size=name, scheme=scheme):
                    self.open(size, scheme)
                    self.script("scrollTo(0, 0)")
                    width, num_colors = self.screenshot(name + "_" + scheme)
                    self.assertEqual(width, size[0])
                    self.assertGreater(num_colors, 100)
                    page = self.script("return getComputedStyle(document.body).backgroundColor")
                    for channel in re.findall(r"\d+", page)[:3]:
                        self.assertTrue(is_right(int(channel)), page)
                    overflow = self.script(
                        """const page = document.documentElement;
                        return page.scrollWidth - page.clientWidth"""
                    )
                    self.assertLessEqual(overflow, 0)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
