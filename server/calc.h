#ifndef SRV_CALC_H
#define SRV_CALC_H

/*
 * `masspropd calc [OPTIONS] FILE...`: the report without a server.  ${argv}[0] is "calc".
 * Exit status: 0 good, 1 some mesh is no solid under --strict, 2 some file could not be read.
 */
int srv_calc_main(int argc, char **argv);

#endif
