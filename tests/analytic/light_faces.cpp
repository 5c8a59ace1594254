// The faces that the RSM pass makes, to turn its texels back into world rays.
#include "../../passes/rsm/light_faces.cpp"  // NOLINT(bugprone-suspicious-include): a pass is no library
