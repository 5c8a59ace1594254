// What the RadianceField pass computes on the CPU, for the tests to call.
// NOLINTBEGIN(bugprone-suspicious-include): a pass is no library
#include "../../passes/radiance_field/probe_grid.cpp"
#include "../../passes/radiance_field/texel_weights.cpp"
// NOLINTEND(bugprone-suspicious-include)
