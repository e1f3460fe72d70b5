/* SPDX-License-Identifier: MIT */
#include "interrupt.h"

#include <glib-unix.h>
#include <signal.h>

static const int watched[] = {SIGINT, SIGTERM, SIGHUP};

static struct {
    InterruptHandler handler;
    void *cookie;
    guint sources[G_N_ELEMENTS(watched)];
    int signal, count;
} state;

static gboolean on_signal(gpointer number)
{
    state.signal = GPOINTER_TO_INT(number);
    state.count++;
    state.handler(state.cookie, state.signal != SIGINT || state.count > 1);
    return G_SOURCE_CONTINUE;
}

void interrupt_watch(InterruptHandler on_interrupt, void *cookie)
{
    state.handler = on_interrupt;
    state.cookie = cookie;
    signal(SIGPIPE, SIG_IGN);
    for (size_t i = 0; i < G_N_ELEMENTS(watched); i++)
        state.sources[i] = g_unix_signal_add(watched[i], on_signal, GINT_TO_POINTER(watched[i]));
}

void interrupt_unwatch(void)
{
    for (size_t i = 0; i < G_N_ELEMENTS(watched); i++)
        g_source_remove(state.sources[i]);
}

int interrupt_signal(void)
{
    return state.signal;
}
