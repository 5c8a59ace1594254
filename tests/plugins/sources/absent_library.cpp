extern "C" __attribute__((visibility("default"))) int absent_answer() { return 42; }
