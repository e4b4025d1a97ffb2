/*
 * fuzz_NAME RUNS KEEP PATH...: main() of a fuzz target where libFuzzer is not at hand.
 *
 * Feeds every file of the given folders (or the files themselves) to the target, then RUNS
 * mutations of them, the same on every machine.  The input in work is mirrored into the file
 * KEEP, so that it is still there when the target crashes or hangs; `fuzz_NAME 0 - KEEP` repeats
 * it alone.  Prints TAP.
 */
#include <dirent.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { MAX_SIZE = 1 << 16, MAX_SEEDS = 1024 };

struct input {
	uint8_t *bytes;
	size_t size;
};

static struct input seeds[MAX_SEEDS];
static size_t seed_count, inputs_run;
static uint8_t *mirror; /* MAX_SIZE bytes of the file KEEP; NULL without one */
static int mirror_fd = -1;
static uint64_t random_state = 1;

static void die(const char *what)
{
	perror(what);
	exit(1);
}

/* splitmix64 (Steele, Lea, Flood 2014, doi:10.1145/2660193.2660195). */
static uint64_t random_u64(void)
{
	uint64_t z = random_state += 0x9e3779b97f4a7c15u;

	z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
	z = (z ^ z >> 27) * 0x94d049bb133111ebu;
	return z ^ z >> 31;
}

static size_t below(size_t n) /* n > 0 */
{
	return (size_t)(random_u64() % n);
}

static void add_file(const char *path)
{
	struct input *seed = &seeds[seed_count];
	FILE *f;

	if (seed_count == MAX_SEEDS)
		return;
	seed_count++;
	if ((f = fopen(path, "rb")) == NULL || (seed->bytes = malloc(MAX_SIZE)) == NULL)
		die(path);
	seed->size = fread(seed->bytes, 1, MAX_SIZE, f);
	fclose(f);
}

static int visible(const struct dirent *entry)
{
	return entry->d_name[0] != '.';
}

static void add_path(const char *path)
{
	struct stat st;
	struct dirent **names;
	int n;

	if (stat(path, &st) != 0)
		die(path);
	if (!S_ISDIR(st.st_mode)) {
		add_file(path);
		return;
	}
	if ((n = scandir(path, &names, visible, alphasort)) < 0)
		die(path);
	for (int i = 0; i < n; i++) {
		char full[4096];

		if (snprintf(full, sizeof full, "%s/%s", path, names[i]->d_name) < (int)sizeof full)
			add_file(full);
		free(names[i]);
	}
	free(names);
}

static void open_mirror(const char *path)
{
	void *map;

	if (strcmp(path, "-") == 0)
		return;
	if ((mirror_fd = open(path, O_RDWR | O_CREAT | O_TRUNC, 0644)) < 0)
		die(path);
	map = mmap(NULL, MAX_SIZE, PROT_READ | PROT_WRITE, MAP_SHARED, mirror_fd, 0);
	if (map == MAP_FAILED)
		die(path);
	mirror = map;
}

/* On a heap copy of the exact size, for the sanitizers to see every overread. */
static void run(const uint8_t *bytes, size_t size)
{
	uint8_t *copy = malloc(size ? size : 1);

	if (copy == NULL)
		die("malloc");
	memcpy(copy, bytes, size);
	if (mirror_fd >= 0) {
		if (ftruncate(mirror_fd, (off_t)size) != 0)
			die("ftruncate");
		memcpy(mirror, bytes, size);
	}
	LLVMFuzzerTestOneInput(copy, size);
	free(copy);
	inputs_run++;
}

/* Bytes that programs trip over: limits of integers, parts of the formats' and options' words. */
static size_t nasty(uint8_t *to)
{
	static const char *const words[] = {
	    "facet ",  "vertex ", "endsolid", "solid ", "nan", "1e999", "-0", "\r\n",  "\n", " ",
	    "density", "=",       "&",        "%00",    "--",  ",",     "\"", "DRACO", "f ", "v "};
	static const uint32_t numbers[] = {0, 1, 0x7fffffff, 0x80000000, 0xffffffff, 0x7fc00000};
	const size_t n = sizeof words / sizeof *words, m = sizeof numbers / sizeof *numbers;
	const size_t k = below(n + m);

	if (k < n) {
		memcpy(to, words[k], strlen(words[k]));
		return strlen(words[k]);
	}
	memcpy(to, &numbers[k - n], 4);
	return 4;
}

/* One random change to ${size} > 0 bytes of ${b}, which has room for MAX_SIZE; the new size. */
static size_t mutate(uint8_t *b, size_t size)
{
	const struct input *other = &seeds[below(seed_count)];
	const size_t at = below(size), len = below(size - at < 64 ? size - at : 64) + 1;
	uint8_t word[16];
	size_t n;

	switch (below(7)) {
	case 0: /* flip a bit */
		b[at] ^= (uint8_t)(1u << below(8));
		return size;
	case 1: /* any byte */
		b[at] = (uint8_t)random_u64();
		return size;
	case 2: /* cut the end off */
		return at;
	case 3: /* cut a piece out */
		memmove(b + at, b + at + len, size - at - len);
		return size - len;
	case 4: /* say a piece twice */
		if (size + len > MAX_SIZE)
			return size;
		memmove(b + at + len, b + at, size - at);
		return size + len;
	case 5: /* overwrite with something nasty */
		n = nasty(word);
		memcpy(b + at, word, size - at < n ? size - at : n);
		return size;
	default: /* go on as another seed does */
		if (at >= other->size)
			return size;
		memcpy(b + at, other->bytes + at, other->size - at);
		return other->size;
	}
}

int main(int argc, char **argv)
{
	static uint8_t work[MAX_SIZE];
	long runs;

	if (argc < 4) {
		fprintf(stderr, "usage: %s RUNS KEEP PATH...\n", argv[0]);
		return 2;
	}
	runs = strtol(argv[1], NULL, 10);
	open_mirror(argv[2]);
	for (int i = 3; i < argc; i++)
		add_path(argv[i]);
	printf("1..1\n");
	fflush(stdout);
	for (size_t i = 0; i < seed_count; i++)
		run(seeds[i].bytes, seeds[i].size);
	for (long i = 0; i < runs && seed_count > 0; i++) {
		const struct input *seed = &seeds[below(seed_count)];
		size_t size = seed->size;

		memcpy(work, seed->bytes, size);
		for (size_t changes = below(4) + 1; changes > 0 && size > 0; changes--)
			size = mutate(work, size);
		run(work, size);
	}
	printf("%sok 1 - %zu inputs from %zu seeds\n", seed_count ? "" : "not ", inputs_run,
	       seed_count);
	for (size_t i = 0; i < seed_count; i++)
		free(seeds[i].bytes);
	return seed_count == 0;
}
