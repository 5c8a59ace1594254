# Run at every build: writes OUTPUT, a header with the commit of SOURCE (a `+` behind it where files were changed; empty
# where it is no checkout), only when that is another than before.
execute_process(COMMAND git -C ${SOURCE} describe --always --dirty=+ --exclude=*
                OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
file(CONFIGURE OUTPUT ${OUTPUT} @ONLY CONTENT [[
#pragma once
#define LOOM_COMMIT "@commit@"
]])
