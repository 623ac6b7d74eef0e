#pragma once

/// The parts of report.html, texts that end with a zero: the page with marks where the others go,
/// and the libraries three.js, its OrbitControls and Chart.js.
extern "C" {
extern const char paperbake_report_page[], paperbake_report_three[], paperbake_report_orbit[],
    paperbake_report_chart[];
}
