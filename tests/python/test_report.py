"""Clicks through a report in a headless browser and looks at the picture.

SANDGATE_PAGE, SANDGATE_LOG (what it was made of), SANDGATE_PHASES (a page of two materials), SANDGATE_BROWSER (program), SANDGATE_PICTURES (folder for pictures)
"""

import base64
import io
import os
import pathlib

import numpy as np
import pytest
from matplotlib.image import imread
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory
from playwright.sync_api import expect, sync_playwright

PAGE = pathlib.Path(os.environ["SANDGATE_PAGE"]).as_uri()
PHASES = pathlib.Path(os.environ["SANDGATE_PHASES"]).as_uri()
PICTURES = pathlib.Path(os.environ["SANDGATE_PICTURES"])


@pytest.fixture(scope="module")
def browser():
    with sync_playwright() as playwright:
        # A container has no user namespaces to make a sandbox of; the page is our own file.
        options = {"executable_path": os.environ["SANDGATE_BROWSER"], "args": ["--no-sandbox", "--disable-gpu"]}
        browser = playwright.chromium.launch(**options)
        yield browser
        browser.close()


@pytest.fixture
def page(browser):
    """The page without a network; a request or an error of its scripts fails the test."""
    context = browser.new_context(viewport={"width": 1280, "height": 900}, offline=True, color_scheme="light")
    page = context.new_page()
    asked, errors = [], []
    page.on("request", lambda request: asked.append(request.url))
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.on("console", lambda line: errors.append(line.text) if line.type == "error" else None)
    page.goto(PAGE)
    yield page
    assert set(asked) <= {PAGE, PHASES} and asked[0] == PAGE
    assert errors == []
    context.close()


def pixels(page):
    """The player's canvas as an array height x width x 4. As PNG: numbers one by one would take seconds."""
    url = page.evaluate("document.getElementById('view').toDataURL('image/png')")
    image = imread(io.BytesIO(base64.b64decode(url.split(",")[1])), format="png")
    return np.rint(image * 255).astype(np.uint8)


def coloured(page, variable):
    """Where the canvas has a colour of the style sheet."""
    wanted = page.evaluate(
        """(name) => {
            const c = document.createElement("canvas").getContext("2d");
            c.fillStyle = css(name); c.fillRect(0, 0, 1, 1);
            return Array.from(c.getImageData(0, 0, 1, 1).data);
        }""",
        variable,
    )
    return (np.abs(pixels(page).astype(int) - wanted).max(axis=2) < 8).nonzero()


def go(page, index):
    page.evaluate("(i) => { const s = byId('slider'); s.value = i; s.dispatchEvent(new Event('input')); }", index)


def test_what_stands_at_the_top(page):
    assert page.title() == 'Silo </script><b>& "gate"'
    expect(page.locator("h1")).to_have_text('Silo </script><b>& "gate"')
    expect(page.locator("#subtitle")).to_contain_text('ended "finished"')
    tiles = page.locator(".tile").all_inner_texts()
    assert any("0.2 s" in tile and "simulated time" in tile for tile in tiles), tiles
    assert any("exact" in tile for tile in tiles), tiles
    page.screenshot(path=PICTURES / "light.png", full_page=True)


def test_gauges_have_units_and_their_last_values(page):
    charts = page.locator("#devices .chart")
    titles = charts.locator("h3").all_inner_texts()
    for title in ("gauge.level.depth", "gauge.surface.depth", "gate.main", "gauge.load.force"):
        assert any(title.startswith(t) or t.startswith(title) for t in titles), titles
    for text in charts.all_text_contents():
        assert "time [s]" in text
    units = {t for t in page.locator("#devices svg text").all_text_contents() if t.startswith("[")}
    assert {"[m]", "[N]", "[kg/s]", "[1]"} <= units, units
    depth = page.locator(".chart", has_text="gauge.level.depth").locator("svg")
    depth.scroll_into_view_if_needed()
    box = depth.bounding_box()
    page.mouse.move(box["x"] + box["width"] - 10, box["y"] + 40)
    with open(os.environ["SANDGATE_LOG"], "rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        topic = "sandgate/v1/small_silo/out/gauge/level.depth"
        *_, (_, _, _, last) = reader.iter_decoded_messages(topics=[topic])
    shown = page.locator("#tip").inner_text()
    assert "t = 0.2 s" in shown
    assert abs(float(shown.split("gauge.level.depth: ")[1].split()[0]) - last.values[0]) < 1e-3 * max(last.values[0], 1)


def test_the_slider_moves_particles_and_cursors(page):
    page.locator("#colour").select_option("asleep")
    page.locator("#gauges").uncheck()
    go(page, 0)
    rows, columns = coloured(page, "--s0")
    # Outflows are drawn in the same colour, further down than the gate that the fill stands on.
    above = rows < coloured(page, "--gate")[0].min()
    rows, columns = rows[above], columns[above]
    # At the start the fill is a block of 8 cm by 6.4 cm. Discs cover pi/4 of it, less a softened edge of a pixel: of
    # nine pixels across about eight have the colour itself, which leaves 0.62, and the walls lie on top.
    wide, high = np.ptp(columns), np.ptp(rows)
    assert abs(wide / high - 8 / 6.4) < 0.05
    assert 0.5 * wide * high < len(rows) < 0.79 * wide * high
    start, cursor = pixels(page), page.locator("svg .now").first.get_attribute("x1")
    bottom = rows.max()
    last = int(page.locator("#slider").get_attribute("max"))
    assert last == 20
    go(page, last)
    expect(page.locator("#when")).to_have_text("t = 0.200 s")
    assert page.locator("svg .now").first.get_attribute("x1") != cursor
    rows, columns = coloured(page, "--s0")
    # The gate has opened: material is below where the fill began, and above the outflow.
    assert ((rows > bottom + 20) & (rows < bottom + 80)).sum() > 20
    assert (pixels(page) != start).any()


def test_the_gate_is_drawn_where_it_is(page):
    page.locator("#gauges").uncheck()
    places = []
    for index in (0, 10):
        go(page, index)
        rows, columns = coloured(page, "--gate")
        assert len(rows) > 20
        places.append(columns.min())
    # Open, it has moved to the right by its own length.
    assert places[1] > places[0] + 20


def test_every_colour_paints_and_has_its_legend(page):
    go(page, 12)
    seen = []
    for colour, legend in [
        ("speed", "speed [m/s]"),
        ("pressure", "pressure [Pa]"),
        ("inertial", "inertial number [1]"),
        ("asleep", "awake"),
    ]:
        page.locator("#colour").select_option(colour)
        expect(page.locator("#legend")).to_contain_text(legend)
        picture = pixels(page).tobytes()
        assert picture not in seen
        seen.append(picture)
        page.locator("#particles .card").screenshot(path=PICTURES / f"{colour}.png")


def test_it_plays_and_pauses(page):
    page.locator("#rate").select_option("0.1")
    # Clicks and looks at once: 0.2 s at a tenth of real time may be over before a busy machine looks again.
    assert page.evaluate("() => { byId('play').click(); return byId('play').textContent; }") == "Pause"
    page.wait_for_function(
        "() => Number(byId('slider').value) >= 3 && (byId('play').textContent !== 'Pause' || (byId('play').click(), true))"
    )
    expect(page.locator("#play")).to_have_text("Play")
    held = page.locator("#slider").input_value()
    page.wait_for_timeout(300)
    assert page.locator("#slider").input_value() == held
    page.locator("#play").click()
    page.wait_for_function("(held) => Number(byId('slider').value) !== held", arg=int(held))


def test_a_click_on_a_curve_goes_to_its_time(page):
    go(page, 0)
    curve = page.locator(".chart", has_text="gauge.level.depth").locator("svg")
    curve.scroll_into_view_if_needed()
    box = curve.bounding_box()
    page.mouse.click(box["x"] + box["width"] * 0.7, box["y"] + 40)
    assert 10 <= int(page.locator("#slider").input_value()) <= 16


def test_light_and_dark(page):
    background = "getComputedStyle(document.body).backgroundColor"
    light = page.evaluate(background)
    page.locator("#theme").click()
    dark = page.evaluate(background)
    assert light != dark and dark == "rgb(19, 20, 22)"
    go(page, 12)
    page.screenshot(path=PICTURES / "dark.png", full_page=True)


def test_a_narrow_screen_has_no_sideways_scroll(page):
    page.set_viewport_size({"width": 390, "height": 800})
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    page.screenshot(path=PICTURES / "narrow.png")


def test_materials_have_colours_of_their_own(page):
    assert page.locator("#colour option[value=phase]").count() == 0, "one material needs no colours"
    page.goto(PHASES)
    page.locator("#gauges").uncheck()
    page.locator("#colour").select_option("phase")
    expect(page.locator("#legend")).to_contain_text("water")
    expect(page.locator("#legend")).to_contain_text("silt")
    places = {}
    for index in (0, int(page.locator("#slider").get_attribute("max"))):
        go(page, index)
        for colour in ("--s0", "--s1"):
            rows, columns = coloured(page, colour)
            assert len(rows) > 100, (index, colour)
            places[index, colour] = rows.mean(), columns.max()
    # At the start silt lies below water (rows count downwards); later both have come further to the right.
    water, silt = places[0, "--s0"], places[0, "--s1"]
    assert silt[0] > water[0] + 5
    assert places[index, "--s1"][1] > silt[1] + 3
    page.locator("#particles .card").screenshot(path=PICTURES / "phase.png")
