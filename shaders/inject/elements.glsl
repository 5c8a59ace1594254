// Elements in rows: a dispatch has at most 65535 work groups along each axis. ROW as in passes/inject/inject.cpp.
const int ROW = 4096;
int element_index() { return int(gl_GlobalInvocationID.x) + ROW * int(gl_GlobalInvocationID.y); }
