"""Opens a run's report.html in a headless Chromium, as a user does from a folder.

Usage: report_browser_test.py PROGRAMS_DIR WORLD_FILE OUTPUT_DIR
Exit code 77: skipped, since the browser, its driver or selenium is not installed.
"""

import base64
import json
import math
import os
import re
import shutil
import subprocess
import sys
import unittest

SKIPPED = 77
try:
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.actions.wheel_input import ScrollOrigin
    from selenium.webdriver.common.by import By
    from selenium.webdriver.common.keys import Keys
except ImportError:
    print("SKIPPED: python3-selenium is not installed")
    sys.exit(SKIPPED)
BROWSER = shutil.which("chromium") or shutil.which("chromium-browser")
DRIVER = shutil.which("chromedriver")
if not BROWSER or not DRIVER:
    print("SKIPPED: chromium or chromium-driver is not installed")
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


def start_browser():
    options = webdriver.ChromeOptions()
    options.binary_location = BROWSER
    for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--disable-gpu"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    return webdriver.Chrome(service=Service(DRIVER), options=options)


class ReportTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        make_report()
        cls.browser = start_browser()

    @classmethod
    def tearDownClass(cls):
        cls.browser.quit()

    def setUp(self):
        self.open(DESKTOP)

    def tearDown(self):
        severe = [entry for entry in self.browser.get_log("browser") if entry["level"] == "SEVERE"]
        self.assertEqual(severe, [])

    def open(self, size, scheme="light"):
        self.command(
            "Emulation.setDeviceMetricsOverride",
            width=size[0],
            height=size[1],
            deviceScaleFactor=1,
            mobile=size == PHONE,
        )
        self.command(
            "Emulation.setEmulatedMedia",
            features=[{"name": "prefers-color-scheme", "value": scheme}],
        )
        self.browser.get("file://" + REPORT)
        self.script("return Promise.all([...document.images].map((image) => image.decode()))")
        self.script("document.getElementById('stage').scrollIntoView({block: 'center'})")

    def command(self, name, **arguments):
        return self.browser.execute_cdp_cmd(name, arguments)

    def script(self, text, *arguments):
        return self.browser.execute_script(text, *arguments)

    def find(self, selector):
        return self.browser.find_element(By.CSS_SELECTOR, selector)

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
        text = self.find("#position").text.replace("\u2212", "-")
        return [float(number) for number in re.findall(r"-?[\d.]+", text)]

    def divided_at(self):
        return float(self.find("#divide").get_property("value"))

    def screenshot(self, name):
        """Saves what the window shows; returns its width and its number of colours."""
        png = self.browser.get_screenshot_as_base64()
        with open(os.path.join(OUTPUT, name + ".png"), "wb") as file:
            file.write(base64.b64decode(png))
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
        self.browser.get_log("performance")
        self.open(DESKTOP)
        urls = []
        for entry in self.browser.get_log("performance"):
            message = json.loads(entry["message"])["message"]
            if message["method"] == "Network.requestWillBeSent":
                urls.append(message["params"]["request"]["url"])
        foreign = [url for url in urls if not url.startswith("data:")]
        self.assertEqual(len(foreign), 1, foreign)
        self.assertTrue(foreign[0].endswith("/run/report.html"))
        policy = self.find("meta[http-equiv=Content-Security-Policy]").get_attribute("content")
        self.assertIn("default-src 'none'", policy)
        # The policy is in force: a picture from elsewhere is refused. It logs an error of its own.
        refused = self.browser.execute_async_script(
            "const done = arguments[0]; const image = new Image();"
            "document.addEventListener('securitypolicyviolation', () => done(true));"
            "image.onload = () => done(false); image.src = 'http://127.0.0.1:9/x.png'"
        )
        self.assertTrue(refused)
        self.browser.get_log("browser")

    def test_shows_texts_as_they_are(self):
        self.assertEqual(self.find("h1").text, os.path.basename(LOG))
        self.assertEqual(self.browser.find_elements(By.CSS_SELECTOR, "h1 img"), [])

    def test_mouse_and_keys_move_the_divider(self):
        before = self.layer("Refined")["clip"], self.layer("Odometry")["clip"]
        self.assertEqual(self.divided_at(), 50)
        grip = self.find("#divider")
        ActionChains(self.browser).drag_and_drop_by_offset(grip, -200, 0).perform()
        stage = self.find("#stage").rect["width"]
        self.assertAlmostEqual(self.divided_at(), 50 - 100 * 200 / stage, delta=1)
        after = self.layer("Refined")["clip"], self.layer("Odometry")["clip"]
        self.assertNotEqual(after[0], before[0])
        self.assertNotEqual(after[1], before[1])
        dragged_to = self.divided_at()
        self.find("#divide").send_keys(Keys.ARROW_RIGHT)
        self.assertGreater(self.divided_at(), dragged_to)
        self.assertNotEqual(self.layer("Refined")["clip"], after[0])

    def test_the_wheel_zooms_about_the_cursor(self):
        stage = self.find("#stage")
        ActionChains(self.browser).move_to_element_with_offset(stage, 210, 60).perform()
        before, zoom = self.position(), self.zoom_of("Refined")
        origin = ScrollOrigin.from_element(stage, 210, 60)
        ActionChains(self.browser).scroll_from_origin(origin, 0, -240).perform()
        self.assertGreater(self.zoom_of("Refined"), 1.5 * zoom)
        for at, was in zip(self.position(), before):
            self.assertAlmostEqual(at, was, delta=0.03)

    def test_buttons_and_keys_zoom_and_reset(self):
        start, zoom = self.layer("Refined")["transform"], self.zoom_of("Refined")
        self.find("#zoom-in").click()
        self.assertAlmostEqual(self.zoom_of("Refined"), 1.5 * zoom, delta=1e-3 * zoom)
        self.find("#zoom-out").click()
        self.assertAlmostEqual(self.zoom_of("Refined"), zoom, delta=1e-3 * zoom)
        stage = self.find("#stage")
        stage.send_keys("+")
        self.assertAlmostEqual(self.zoom_of("Refined"), 1.5 * zoom, delta=1e-3 * zoom)
        stage.send_keys("-")
        moved = self.layer("Refined")["transform"]
        stage.send_keys(Keys.ARROW_LEFT)
        self.assertNotEqual(self.layer("Refined")["transform"], moved)
        stage.send_keys("0")
        self.assertEqual(self.layer("Refined")["transform"], start)
        for _ in range(12):
            self.find("#zoom-in").click()
        self.assertEqual(self.layer("Refined")["rendering"], "pixelated")
        self.find("#zoom-reset").click()
        self.assertEqual(self.layer("Refined")["transform"], start)

    def test_dragging_takes_the_map_along(self):
        stage = self.find("#stage")
        chain = ActionChains(self.browser).move_to_element_with_offset(stage, 200, 50)
        chain.perform()
        before = self.position()
        chain = ActionChains(self.browser).click_and_hold().move_by_offset(80, 40).release()
        chain.perform()
        for at, was in zip(self.position(), before):
            self.assertAlmostEqual(at, was, delta=0.03)
        zoom = self.zoom_of("Refined")
        ActionChains(self.browser).double_click().perform()
        self.assertAlmostEqual(self.zoom_of("Refined"), 2 * zoom, delta=1e-3 * zoom)

    def test_other_maps_can_be_chosen(self):
        self.assertEqual(self.layer("Seed")["visibility"], "hidden")
        self.find("#map-left").send_keys("Seed")
        self.assertEqual(self.layer("Seed")["visibility"], "visible")
        self.assertEqual(self.layer("Odometry")["visibility"], "hidden")

    def test_two_fingers_zoom(self):
        self.open(PHONE)
        box = self.script("return document.getElementById('stage').getBoundingClientRect()")
        x, y = box["left"] + 0.25 * box["width"], box["top"] + box["height"] / 2
        zoom = self.zoom_of("Refined")

        def touch(kind, *offsets):
            points = [{"x": x + offset, "y": y, "id": i} for i, offset in enumerate(offsets)]
            self.command("Input.dispatchTouchEvent", type=kind, touchPoints=points)

        touch("touchStart", -20)
        touch("touchStart", -20, 20)
        for distance in range(20, 61, 5):
            touch("touchMove", -distance, distance)
        touch("touchEnd")
        self.assertGreater(self.zoom_of("Refined"), 2 * zoom)
        for _ in range(2):
            touch("touchStart", 0)
            touch("touchEnd")
        self.assertGreater(self.zoom_of("Refined"), 4 * zoom)

    def test_charts_are_drawn_and_explain_themselves(self):
        plot = self.find("[data-plot='0']")
        self.script("arguments[0].scrollIntoView({block: 'center'})", plot)
        marks = plot.find_elements(By.CSS_SELECTOR, "circle")
        self.assertGreater(len(marks), 2)
        ActionChains(self.browser).move_to_element(marks[1]).perform()
        self.assertIn("energy", plot.find_element(By.CSS_SELECTOR, ".tip").text)
        label = plot.find_element(By.CSS_SELECTOR, "text.label")
        self.assertEqual(label.text, "seconds")
        self.find("input[name=plot-0] ~ *, .switch label:last-child").click()
        self.assertEqual(plot.find_element(By.CSS_SELECTOR, "text.label").text, "iterations")
        for chart in self.browser.find_elements(By.CSS_SELECTOR, "[data-histogram]"):
            heights = [float(bar.get_attribute("height"))
                       for bar in chart.find_elements(By.CSS_SELECTOR, "rect.bin")]
            self.assertGreater(max(heights), 100)
            self.assertTrue(all(math.isfinite(height) for height in heights))

    def test_errors_by_stage_fall(self):
        plot = self.find("[data-stage-plot='0']")
        self.script("arguments[0].scrollIntoView({block: 'center'})", plot)
        marks = plot.find_elements(By.CSS_SELECTOR, "circle")
        heights = [float(mark.get_attribute("cy")) for mark in marks]
        self.assertEqual(len(heights) % 2, 0)  # of poses, then of the map
        self.assertLess(heights[0] + 50, heights[len(heights) // 2 - 1])
        ActionChains(self.browser).move_to_element(marks[0]).perform()
        self.assertIn("odometry, pose", plot.find_element(By.CSS_SELECTOR, ".tip").text)

    def test_tables_need_no_scrolling_on_a_desktop(self):
        wider = """
            return [...document.querySelectorAll('section .scroll')]
                .filter((box) => box.scrollWidth > box.clientWidth)
                .map((box) => box.getAttribute('aria-label'))"""
        self.assertEqual(self.script(wider), [])

    def test_options_can_be_searched(self):
        self.find("#options summary").click()
        rows = self.browser.find_elements(By.CSS_SELECTOR, ".options tbody tr")
        self.assertTrue(all(row.is_displayed() for row in rows))
        self.find("#option-search").send_keys("sigma_range")
        shown = [row.text for row in rows if row.is_displayed()]
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
                        "return document.documentElement.scrollWidth - innerWidth"
                    )
                    self.assertLessEqual(overflow, 0)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
