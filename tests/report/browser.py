"""The reports in a real Chromium: browser.py PROGRAM FOLDER.  PROGRAM: build/fjr; FOLDER: for plans and pages.

At the widths of a desk and of a phone, by day and by night: no message on the console, play, scrub, overlay, export. Leaves with
77 where there is no Chromium, chromedriver or Selenium, which Debian has as chromium, chromium-driver and python3-selenium.
"""
import base64
import itertools
import json
import re
import shutil
import subprocess
import sys
import time
import unittest
import xml.etree.ElementTree as ElementTree
from pathlib import Path

try:
    from selenium import webdriver
    from selenium.webdriver.chrome.options import Options
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.common.by import By
except ImportError:
    print("skipped: there is no Selenium (python3-selenium)")
    sys.exit(77)

WIDTHS = {"desk": 1280, "phone": 390}
VIEWS = [(width, night) for width in WIDTHS for night in (False, True)]
# A disc beyond the arm's reach on the right, one at its edge below, and a label that would run out of the picture.
OBSTACLES = "obstacles:\n  - {center: [0.95, 0.2], radius: 0.1}\n  - {center: [0.0, -0.8], radius: 0.1, margin: 0.02}\n"
ROBOT = Path(__file__).parents[2] / "config/robot.yaml"
REQUESTS = {
    "first": "start: {q: [0.0, 0.0]}\ngoal: {q: [0.6, -0.4]}\n" + OBSTACLES,
    "second": "start: {q: [0.0, 0.0]}\ngoal: {q: [0.6, -0.4]}\nduration: 0.6\nobjective: {link_acceleration: 1}\n",
    "robust": "robot: uncertain.yaml\nstart: {q: [0.0, 0.0]}\ngoal: {q: [0.3, -0.2]}\nrobust: {confidence: 0.5}\n",
    "impossible": "start: {q: [0.0, 0.0]}\ngoal: {q: [0.6, -0.4]}\nduration: 0.1\n" + OBSTACLES,
}
# An arm of a third of the length, on a slope of 30 degrees that pulls it to the right.
SMALL = Path(__file__).resolve().parents[2] / "config/robots/asr_twodof.yaml"
SLOPE = "\nmounting: {inclination: 0.523599, down: 1.570796}\n"
CONTRAST = 4.5  # WCAG 2.1, AA


def make_pages(program, folder):
    """Plans of REQUESTS and the reports on them; of `robust` with springs that are known to 1 %."""
    text, springs = re.subn(r"(stiffness: .*standard_error: )null", r"\1[0.2, 0.18]", ROBOT.read_text())
    assert springs == 1
    (folder / "uncertain.yaml").write_text(text)
    (folder / "small.yaml").write_text(SMALL.read_text() + SLOPE)
    (folder / "slope.yaml").write_text("robot: small.yaml\nstart: {q: [0.0, 0.0]}\ngoal: {q: [0.2, 0.1]}\n")
    subprocess.run([program, "plan", "-q", folder / "slope.yaml", "--out", folder / "slope", "--report"],
                   check=True, stdout=subprocess.DEVNULL)
    for name, text in REQUESTS.items():
        (folder / f"{name}.yaml").write_text(text)
        command = [program, "plan", "-q", folder / f"{name}.yaml", "--out", folder / name, "--report", "--starts", "1"]
        if name == "impossible":
            command += ["--deadline", "1"]  # to explain takes longer, and is not what is looked at
        subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    subprocess.run([program, "report", folder / "first", folder / "second"], check=True, stdout=subprocess.DEVNULL)


def browser():
    options = Options()
    for argument in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--hide-scrollbars=false"):
        options.add_argument(argument)
    options.binary_location = shutil.which("chromium")
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    return webdriver.Chrome(options=options, service=Service(shutil.which("chromedriver")))


class Pages(unittest.TestCase):
    def open(self, page, width="desk", night=False):
        """At this width, once everything is drawn."""
        print(f"    {page}, {width}{', by night' if night else ''}")
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
            "width": WIDTHS[width], "height": 900, "deviceScaleFactor": 1, "mobile": width == "phone"})
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {
            "features": [{"name": "prefers-color-scheme", "value": "dark" if night else "light"}]})
        self.driver.get((self.folder / page).as_uri())
        self.wait_for("return typeof scale === 'number' && scale > 1 && canvas.width > 100")

    def run_script(self, script, *arguments):
        return self.driver.execute_script(script, *arguments)

    def wait_for(self, script):
        end = time.monotonic() + 20
        while not self.run_script(script):
            self.assertLess(time.monotonic(), end, f"waited in vain for: {script}")
            time.sleep(0.02)

    def picture(self):
        return base64.b64decode(self.run_script("return canvas.toDataURL().split(',')[1]"))

    def choose(self, control, value):
        self.run_script("const c = document.getElementById(arguments[0]); c.value = arguments[1];"
                        "c.dispatchEvent(new Event(c.tagName === 'SELECT' ? 'change' : 'input'))", control, value)

    def assert_silent(self):
        self.assertEqual([entry["message"] for entry in self.driver.get_log("browser")], [])

    def test_every_page_is_silent_and_fits_the_width(self):
        for page in ("first/report.html", "second/report.html", "robust/report.html", "impossible/report.html", "first/compared.html"):
            for width, night in VIEWS:
                with self.subTest(page=page, width=width, night=night):
                    self.open(page, width, night)
                    self.assert_silent()
                    self.assertLessEqual(self.run_script("return document.documentElement.scrollWidth"), WIDTHS[width])

    def test_playing_goes_to_the_end_and_scrubbing_anywhere(self):
        for width, night in VIEWS:
            self.open("first/report.html", width, night)
            begin = self.picture()
            self.choose("speed", "0.05")  # 7 s, so that it is not over before it is looked at
            self.driver.find_element(By.ID, "play").click()
            self.assertEqual(self.driver.find_element(By.ID, "play").text, "Pause")
            self.choose("speed", "1")
            self.wait_for("return !playing")
            end = self.run_script("return [time, lastTime(), document.getElementById('now').textContent]")
            self.assertEqual(end[0], end[1])
            self.assertEqual(end[2], f"{end[1]:.4f} s")
            self.assertNotEqual(self.picture(), begin)
            self.choose("time", "500")
            self.assertAlmostEqual(self.run_script("return time"), end[1] / 2, places=9)
            seen = self.run_script("return linked.map(({chart, line}) => [parseFloat(line.style.transform.slice(11)),"
                                   "chart.scales.x.getPixelForValue(time)])")
            self.assertGreaterEqual(len(seen), 6)
            for drawn, wanted in seen:
                self.assertAlmostEqual(drawn, wanted, delta=0.5)
            self.choose("time", "0")
            self.assertEqual(self.picture(), begin)
            self.assert_silent()

    def test_another_motion_is_laid_over(self):
        pages = {"first/report.html": ["this plan", "minimum jerk", "trapezoidal velocity"],
                 "first/compared.html": ["first", "second"]}
        for (page, others), width in itertools.product(pages.items(), WIDTHS):
            self.open(page, width)
            options = [o.text for o in self.driver.find_elements(By.CSS_SELECTOR, "#beside option")]
            self.assertEqual(options, ["nothing", *others])
            self.choose("time", "400")
            self.choose("beside", "")
            alone = self.picture()
            self.choose("time", "400")
            self.choose("beside", "1")
            self.assertNotEqual(self.picture(), alone)
            self.assert_silent()
        self.open("first/compared.html")
        self.assertEqual(self.run_script("return beside.name"), "second")  # without being asked
        self.assertAlmostEqual(self.run_script("return lastTime()"), 0.6, places=9)  # the longer of the two
        self.assertIn("link 1, second", self.run_script("return charts[0].series.map(s => s.name)"))

    def test_nothing_is_cut_off_in_the_picture(self):
        for page in ("first/report.html", "impossible/report.html"):
            for width, night in VIEWS:
                self.open(page, width, night)
                box = self.run_script(
                    "return plan.scene.flatMap(o => boundsOf[o.kind](o)).map(([x, y, r]) => [...place([x - r, y + r]), ...place([x + r, y - r])])")
                size = self.run_script("return [canvas.clientWidth, canvas.clientHeight]")
                self.assertEqual(len(box), 2)
                for left, top, right, bottom in box:
                    self.assertGreaterEqual(min(left, top), 0)
                    self.assertLessEqual(right, size[0])
                    self.assertLessEqual(bottom, size[1])
                texts = self.run_script(
                    "const seen = [], draw = pen.fillText.bind(pen); pen.fillText = (text, x, y) => { const w = pen.measureText(text).width;"
                    "seen.push([text, x, y, w]); draw(text, x, y); }; drawLabels(); delete pen.fillText; return seen")
                self.assertEqual(len(texts), len(plan_labels(page)))
                for text, x, y, wide in texts:
                    self.assertGreaterEqual(x, 0, text)
                    self.assertLessEqual(x + wide, size[0], text)
                    self.assertTrue(10 < y < size[1], text)

    def test_axes_and_frame_are_drawn(self):
        self.open("first/report.html")
        texts = self.run_script("const seen = [], draw = pen.fillText.bind(pen); pen.fillText = (text, x, y) => { seen.push(String(text));"
                                "draw(text, x, y); }; show(time); delete pen.fillText; return seen")
        for text in ("x (m)", "y (m)", "x", "y", "0", "-0.6"):
            self.assertIn(text, texts)

    def test_gravity_is_an_arrow_of_the_way_it_pulls(self):
        for page, text, way in (("first/report.html", "g", [0, 1]), ("slope/report.html", "0.5 g", [1, 0])):
            self.open(page)
            seen = self.run_script(
                "const seen = [], text = pen.fillText.bind(pen), line = pen.lineTo.bind(pen);"
                "pen.fillText = (t, x, y) => { seen.push(t); text(t, x, y); };"
                "pen.lineTo = (x, y) => { seen.push([x, y]); line(x, y); };"
                "const move = pen.moveTo.bind(pen); pen.moveTo = (x, y) => { seen.push([x, y]); move(x, y); };"
                "drawGravity(); delete pen.fillText; delete pen.lineTo; delete pen.moveTo; return seen")
            (x0, y0), (x1, y1) = seen[:2]
            length = ((x1 - x0)**2 + (y1 - y0)**2)**0.5
            self.assertAlmostEqual((x1 - x0) / length, way[0], places=5)
            self.assertAlmostEqual((y1 - y0) / length, way[1], places=5)
            self.assertEqual(seen[-1], text)
            self.assert_silent()

    def test_marks_are_as_large_as_the_arm_asks_for(self):
        shares = []
        for page in ("second/report.html", "slope/report.html"):
            self.open(page)
            radii = self.run_script("const seen = [], arc = pen.arc.bind(pen);"
                                    "pen.arc = (x, y, r, ...rest) => { seen.push(r); arc(x, y, r, ...rest); };"
                                    "drawArm(0); delete pen.arc; return seen.map(r => r / scale / (plan.arm.length[0] + plan.arm.length[1]))")
            shares.append([min(radii), max(radii)])
        for one, other in zip(*shares):
            self.assertAlmostEqual(one, other, places=9)

    def test_a_request_without_a_motion_shows_what_was_asked_for(self):
        self.open("impossible/report.html")
        self.assertEqual(self.run_script("return plan.poses.map(p => p.label)"), ["start", "goal"])
        self.assertFalse(self.driver.find_element(By.ID, "play").is_displayed())
        self.assertTrue(self.driver.find_element(By.ID, "arm").is_displayed())
        self.assertIn("What was asked for", self.driver.find_element(By.TAG_NAME, "body").text)

    def test_tables_scroll_where_they_are_too_wide_and_show_it(self):
        self.open("first/report.html", "phone")
        tables = self.run_script("return [...document.querySelectorAll('.table')].map(t => [t.scrollWidth, t.clientWidth,"
                                 "getComputedStyle(t).backgroundImage.split('gradient').length - 1])")
        wide = [table for table in tables if table[0] > table[1]]
        self.assertGreater(len(wide), 0)
        for _, _, shadows in wide:
            self.assertEqual(shadows, 4)  # one at each side, and what hides it where there is no more

    def test_every_chart_is_exported_as_svg(self):
        self.open("first/report.html")
        count = self.run_script("return charts.length")
        self.assertEqual(len(self.driver.find_elements(By.CSS_SELECTOR, "button.svg")), count)
        for i in range(count):
            text = self.run_script("return svgOf(drawn[arguments[0]], charts[arguments[0]], 'A <title> & more')", i)
            root = ElementTree.fromstring(text)
            texts = ["".join(node.itertext()) for node in root.iter("{http://www.w3.org/2000/svg}text")]
            self.assertIn("A <title> & more", texts)
            about = self.run_script("return [charts[arguments[0]].x_label, charts[arguments[0]].series.filter(isLine).length]", i)
            self.assertIn(about[0], texts)
            lines = [p for p in root.iter("{http://www.w3.org/2000/svg}path") if p.get("class") == "line"]
            self.assertEqual(len(lines), about[1])
            for line in lines:
                self.assertNotIn("NaN", line.get("d"))
        saved = self.run_script("const seen = []; HTMLAnchorElement.prototype.click = function() { seen.push(this.download) };"
                                "document.querySelector('button.svg').click(); return seen")
        self.assertEqual(saved, ["positions_limits_3_2_and_2_6_rad.svg"])
        self.assert_silent()

    def test_tubes_are_drawn_about_every_limited_quantity(self):
        robustness = json.loads((self.folder / "robust/plan.json").read_text())["certificate"]["robustness"]
        halves = {(m["name"], m["joint"]): m["tube"] for m in robustness["limits"]}
        halves |= {("link", joint + 1): tube for joint, tube in enumerate(robustness["link_tubes_rad"])}
        for night in (False, True):
            self.open("robust/report.html", night=night)
            shown = {"Positions": "link", "Spring deflections": "spring_deflection", "Motor torques": "torque",
                     "Motor velocities": "motor_velocity"}
            titles = self.run_script("return [...document.querySelectorAll('figcaption span')].map(s => s.textContent)")
            for title, name in shown.items():
                chart = next(i for i, text in enumerate(titles) if text.startswith(title))
                for joint in (1, 2):
                    with self.subTest(chart=title, joint=joint, night=night):
                        half = self.run_script(
                            "const area = charts[arguments[0]].series.find(s => s.name === arguments[1]).points, n = area.length;"
                            "return area.slice(0, n / 2).map((p, i) => [p.x, (p.y - area[n - 1 - i].y) / 2])", chart, f"tube {joint}")
                        self.assertGreater(len(half), 100)
                        digits = 1e-6 * max(abs(v) for v in (3.2, 12))  # seven are on the page
                        for time, width in half:
                            at = min(sum(t < time for t in robustness["times"]), len(robustness["times"]) - 1)
                            self.assertAlmostEqual(width, halves[name, joint][at], delta=digits)
                        changed = self.run_script(
                            "const chart = drawn[arguments[0]], look = () => chart.canvas.toDataURL(), before = look();"
                            "const i = chart.data.datasets.findIndex(d => d.label === arguments[1]);"
                            "chart.hide(i); chart.update(); const without = look(); chart.show(i); chart.update();"
                            "return [before !== without, chart.data.datasets[i].fill]", chart, f"tube {joint}")
                        self.assertEqual(changed, [True, "shape"])
            self.assert_silent()
        text = self.driver.find_element(By.TAG_NAME, "body").text
        self.assertIn("Other arms", text)
        self.assertIn("Not covered: " + robustness["not_covered"], text)
        svg = self.run_script("return svgOf(drawn[2], charts[2], 'torques')")
        self.assertEqual(len(re.findall('fill-opacity="0.3"', svg)), 2)

    def test_it_can_be_read_by_night(self):
        for night in (False, True):
            self.open("first/report.html", night=night)
            background = self.colour("body", "backgroundColor")
            self.assertEqual(luminance(background) < 0.1, night)
            for selector in ("body", "td", "th", ".note", "button.at"):
                contrast = contrast_of(self.colour(selector, "color"), background)
                self.assertGreater(contrast, CONTRAST, f"{selector}, {'night' if night else 'day'}")

    def test_the_solver_is_folded_up_and_the_objective_is_named(self):
        self.open("second/report.html")
        table = self.run_script("const d = [...document.querySelectorAll('details')].find(d => /stages/.test(d.querySelector('summary').textContent));"
                                "const shut = d.open; d.querySelector('summary').click(); return [shut, d.open]")
        self.assertEqual(table, [False, True])
        text = self.driver.find_element(By.TAG_NAME, "body").text
        self.assertRegex(text.splitlines()[1], r"objective \d+\.?\d* rad\^2/s\^3 \(link acceleration\)")
        self.assertRegex(text, r"objective: link acceleration \(rad\^2/s\^3\) [\d.]+ [\d.]+ [\d.]+")

    def colour(self, selector, what):
        """[r, g, b] as it is shown."""
        text = self.run_script("return getComputedStyle(document.querySelector(arguments[0]))[arguments[1]]", selector, what)
        return [float(part) for part in text[text.index("(") + 1:-1].split(",")[:3]]


def plan_labels(page):
    return ["obstacles[0]", "obstacles[1]", *(["start", "goal"] if page.startswith("impossible") else [])]


def luminance(colour):
    linear = [v / 255 / 12.92 if v / 255 <= 0.03928 else ((v / 255 + 0.055) / 1.055)**2.4 for v in colour]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast_of(one, other):
    light, dark = sorted((luminance(one), luminance(other)), reverse=True)
    return (light + 0.05) / (dark + 0.05)


def main():
    program, folder = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
    for needed in ("chromium", "chromedriver"):
        if shutil.which(needed) is None:
            print(f"skipped: there is no {needed}")
            sys.exit(77)
    folder.mkdir(parents=True, exist_ok=True)
    make_pages(program, folder)
    Pages.folder, Pages.driver = folder, browser()
    try:
        done = unittest.main(argv=sys.argv[:1], verbosity=2, buffer=True, exit=False)
    finally:
        Pages.driver.quit()
    sys.exit(not done.result.wasSuccessful())


if __name__ == "__main__":
    main()
