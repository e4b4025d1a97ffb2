// bare_draco FILE: decode a Draco mesh with libdraco and do nothing with it.
// Prints the seconds of CPU that decoding took and the number of faces.
#include <draco/compression/decode.h>
#include <draco/core/decoder_buffer.h>
#include <time.h>

#include <cstdio>
#include <fstream>
#include <iterator>
#include <vector>

static double cpu()
{
	struct timespec t;

	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
	return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

int main(int argc, char **argv)
{
	if (argc != 2)
		return 2;
	std::ifstream in(argv[1], std::ios::binary);
	std::vector<char> bytes((std::istreambuf_iterator<char>(in)),
				std::istreambuf_iterator<char>());
	const double start = cpu();
	draco::DecoderBuffer buffer;
	buffer.Init(bytes.data(), bytes.size());
	draco::Decoder decoder;
	auto mesh = decoder.DecodeMeshFromBuffer(&buffer);
	if (!mesh.ok())
		return 1;
	const auto faces = mesh.value()->num_faces();
	std::move(mesh).value().reset();
	std::printf("%.6f %u\n", cpu() - start, static_cast<unsigned>(faces));
	return 0;
}
