extern "C" int bake_six_frames(const char* scene, const char* folder);

int main(int, char** argv) { return bake_six_frames(argv[1], argv[2]); }
