/* SPDX-License-Identifier: MIT */
/*
 * Signals. Ctrl-C (SIGINT) ends the work in order: what is there becomes a playable file. A second one, SIGTERM and
 * SIGHUP end it at once. SIGPIPE is ignored: the output is complete even if nobody reads the progress.
 */
#ifndef INTERRUPT_H
#define INTERRUPT_H

#include <glib.h>

/* Calls on_interrupt in the main loop: at_once FALSE for the first Ctrl-C. */
typedef void (*InterruptHandler)(void *cookie, gboolean at_once);
void interrupt_watch(InterruptHandler on_interrupt, void *cookie);
void interrupt_unwatch(void);

/* The number of the signal that came, or 0. */
int interrupt_signal(void);

#endif
