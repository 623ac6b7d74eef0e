#include "baker/output/report_parts.h"

// The files as they lie in the source tree and in Debian's libjs-three and libjs-chart.js, with a
// zero behind each.
#define EMBED(symbol, file)                                 \
  asm(".pushsection .rodata\n.global " #symbol "\n" #symbol \
      ":\n"                                                 \
      ".incbin \"" file "\"\n.byte 0\n.popsection\n")
EMBED(paperbake_report_page, PAPERBAKE_REPORT_PAGE);
EMBED(paperbake_report_three, PAPERBAKE_REPORT_THREE);
EMBED(paperbake_report_orbit, PAPERBAKE_REPORT_ORBIT);
EMBED(paperbake_report_chart, PAPERBAKE_REPORT_CHART);
#undef EMBED
